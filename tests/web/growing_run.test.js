// Law: a growing run says what was appended, forgets its oldest samples, and scores the analysis window alone.

import assert from "node:assert/strict";
import { test } from "node:test";
import { GrowingRun } from "../../web/growing_run.mjs";

const SERIES = ["psi_o", "signed_order", "rotation"];

/** Samples of two boats, of which the first leads: at these times, with this order in the analysis window or out of it. */
function samples(times, orders, inWindow) {
  return {
    time_s: Float64Array.from(times),
    phase: Float64Array.from(times, () => 0),
    in_analysis_window: Float64Array.from(inWindow, Number),
    pose: Float64Array.from(times.flatMap((time) => [time, 2 * time, 0, 30, 0, Math.PI / 2])),
    velocity: Float64Array.from(times.flatMap(() => [3, 4, 0.5, 0, 0, 0])),
    rudder: Float64Array.from(times, (time) => time / 10),
    series: Float64Array.from(orders.flatMap((order) => [order, order / 2, -order])),
    contacts: Float64Array.of(0, 1, 2.5, 1, 0, 15),
  };
}

const described = { boats: 2, leaders: 1, phases: ["fw", "nop1", "bw", "nop2"] };
const grown = (capacity = 10) => new GrowingRun(described, SERIES, capacity);

test("samples are there once they are appended", () => {
  const run = grown();
  run.append(samples([0, 1], [0.2, 0.4], [false, true]));
  run.append(samples([2], [0.6], [true]));
  assert.equal(run.length, 3);
  assert.equal(run.end, 2);
  assert.deepEqual([-1, 0.5, 1, 9].map((time) => run.sampleAt(time)), [0, 0, 1, 2]);
  assert.deepEqual(run.posesAt(1.5), [[1.5, 3, 0], [30, 0, Math.PI / 2]]);
  assert.equal(run.value("psi_o", 1), 0.4);
  assert.equal(run.columns.get("speed_cm_s").at(0, 0), 5);
  assert.equal(run.rudder(0, 2), 0.2);
  assert.equal(run.phase(0), "fw");
});

test("a leader's angle is clockwise from the outward direction", () => {
  const run = new GrowingRun({ ...described, leaders: 2 }, SERIES, 4);
  run.append({ ...samples([1], [0], [false]), rudder: Float64Array.of(0, 0) });
  // Boat 1 is at (30, 0) and heads along y, counter-clockwise.
  assert.equal(run.orientation(1, 0), -Math.PI / 2);
});

test("when it is full, the older half is forgotten", () => {
  const run = grown(4);
  for (let time = 0; time < 7; time += 1) {
    run.append(samples([time], [time / 10], [false]));
  }
  assert.deepEqual([...run.time], [4, 5, 6]);
  assert.deepEqual([0, 1, 2].map((sample) => run.value("psi_o", sample)), [0.4, 0.5, 0.6]);
  assert.deepEqual(run.posesAt(5)[0], [5, 10, 0]);
});

test("the score is the mean in the analysis window, and starts again with a change", () => {
  const [run, cycles] = [grown(), []];
  run.append(samples([0, 1, 2, 3], [1, 0.2, 0.4, 1], [false, true, true, false]), (order) => cycles.push(order));
  assert.ok(Math.abs(run.mean("signed_order") - 0.15) < 1e-12);
  assert.ok(Math.abs(run.mean("rotation") + 0.3) < 1e-12);
  assert.equal(cycles.length, 1);
  assert.ok(Math.abs(cycles[0] - 0.3) < 1e-12);
  run.describe({ bw_s: 1 });
  assert.ok(Number.isNaN(run.mean("signed_order")));
  run.append(samples([4], [0.8], [true]));
  assert.equal(run.mean("signed_order"), 0.4);
  assert.equal(run.mean("psi_o"), 0.8);
  assert.equal(run.changedAt, 3);
});

test("contacts are those of the latest look, for half a second", () => {
  const run = grown();
  run.append(samples([0, 0.1], [0, 0], [false, false]));
  assert.deepEqual(run.contacts(0), []);
  assert.deepEqual(run.contacts(1), [{ i: 0, j: 1, along: 2.5, angle: 0, force: 15 }]);
  run.append({ ...samples([1], [0], [false]), contacts: new Float64Array(0) });
  assert.deepEqual(run.contacts(2), []);
});

test("more samples at once than half of it push out as many as they need", () => {
  const run = grown(4);
  run.append(samples([0, 1, 2, 3], [0, 0.1, 0.2, 0.3], [false, false, false, false]));
  run.append(samples([4, 5, 6], [0.4, 0.5, 0.6], [false, false, false]));
  assert.deepEqual([...run.time], [3, 4, 5, 6]);
  assert.equal(run.value("psi_o", 0), 0.3);
});

test("each analysis window has a mean of its own", () => {
  const [run, cycles] = [grown(), []];
  run.append(samples([0, 1, 2, 3], [0.25, 1, 0.75, 1], [true, false, true, false]), (order) => cycles.push(order));
  assert.deepEqual(cycles, [0.25, 0.75]);
});

test("contacts that nobody has looked at for half a second are not known", () => {
  const run = grown();
  run.append(samples([0, 0.1], [0, 0], [false, false]));
  run.append(samples([0.4, 0.7, 1], [0, 0, 0], [false, false, false]));
  assert.deepEqual([1, 2, 3, 4].map((sample) => run.contacts(sample).length), [1, 1, 0, 1]);
});
