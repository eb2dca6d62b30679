// Law: axes have round numbers within what they show.

import assert from "node:assert/strict";
import { test } from "node:test";
import { ticks, timeStep } from "../../../flockenv/replay/shared/chart.mjs";

test("round numbers between two", () => {
  assert.deepEqual(ticks(-1, 1, 4), [-1, -0.5, 0, 0.5, 1]);
  assert.deepEqual(ticks(0.3, 9, 3), [5]);
});

test("steps of time are those of a clock", () => {
  assert.deepEqual([0.3, 1, 3, 12, 40, 400, 3000, 9000].map(timeStep), [0.5, 1, 5, 15, 60, 600, 3600, 18000]);
});
