// Law: axes have round numbers within what they show.

import assert from "node:assert/strict";
import { test } from "node:test";
import { Chart, ticks, timeStep } from "../../../flockenv/replay/shared/chart.mjs";
import { canvas } from "../../web/pictures.js";
import { runOf } from "./runs.js";

test("round numbers between two", () => {
  assert.deepEqual(ticks(-1, 1, 4), [-1, -0.5, 0, 0.5, 1]);
  assert.deepEqual(ticks(0.3, 9, 3), [5]);
  // A rounding beyond a round number is that number.
  assert.deepEqual(ticks(0.1 + 0.2, 0.6, 3), [0.3, 0.4, 0.5, 0.6].map((each) => Math.round(10 * each) * 0.1));
});

test("steps of time are those of a clock", () => {
  assert.deepEqual([0.3, 1, 3, 12, 40, 400, 3000, 9000].map(timeStep), [0.5, 1, 5, 15, 60, 600, 3600, 18000]);
});

test("large values are up, late times to the right, and a place is a time again", () => {
  const chart = new Chart({ addEventListener: () => undefined }, [], null, () => undefined);
  Object.assign(chart, { width: 150, height: 128, range: [-1, 1], from: 0, to: 10 });
  // 40 pixels are left of the plot, 8 above it.
  assert.deepEqual([1, 0, -1].map((value) => chart.yOf(value)), [8, 58, 108]);
  assert.deepEqual([0, 5, 10].map((time) => chart.xOf(time)), [40, 90, 140]);
  assert.equal(chart.timeAt(chart.xOf(2.5)), 2.5);
});

test("a chart around the cursor shows the whole run where that is not longer, and never more", () => {
  // The run is from 0 to 1 s.
  for (const [reach, time, from, to] of [[0.6, 0.5, 0, 1], [0.25, 0.5, 0.25, 0.75], [0.25, 0.9, 0.5, 1], [0.25, 0, 0, 0.5], [null, 0.5, 0, 1]]) {
    const picture = Object.assign(canvas(150, 128), { addEventListener: () => undefined });
    globalThis.document.createElement ??= () => canvas(150, 128);
    const chart = new Chart(picture, [runOf()], reach, () => undefined);
    chart.draw(time, { key: "psi_o", range: [0, 1] }, {});
    assert.deepEqual([chart.from, chart.to], [from, to]);
  }
});
