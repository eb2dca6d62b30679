// Law: one sentence says how many boats head which way, and names the way that most of them have.

import assert from "node:assert/strict";
import { test } from "node:test";
import { doing } from "../../web/doing.mjs";

/** A run whose boats stand in the east and head up (counter-clockwise), down (clockwise) or outward. */
function runOf({ up = 0, down = 0, outward = 0, leaders = 0, inner = 50, outer = 90 }) {
  const headings = [...Array(up).fill(Math.PI / 2), ...Array(down).fill(-Math.PI / 2), ...Array(outward).fill(0)];
  return {
    boats: headings.length, leaders, time: [0], lengths: { outer_radius_cm: outer, inner_radius_cm: inner },
    posesAt: () => headings.map((heading) => [70, 0, heading]),
  };
}

test("what most boats do is named, and what none does is counted", () => {
  for (const [boats, words] of [
    [{ down: 27 }, "27 boats; all clockwise."],
    [{ down: 25, outward: 2 }, "27 boats; nearly all clockwise."],
    [{ up: 18, down: 9, leaders: 3 }, "27 boats, 3 of them lead; most counter-clockwise."],
    [{ outward: 10 }, "10 boats; all against a wall."],
    [{ up: 5, down: 5 }, "10 boats; 5 clockwise, 5 counter-clockwise."],
    [{ up: 2, inner: 0, outer: null }, "2 boats, in open water."],
  ]) {
    assert.equal(doing(runOf(boats), 0, { "circles-from": "0.5" }), words);
  }
});
