// Law: one sentence says how many boats head which way, and names the way that most of them have.

import assert from "node:assert/strict";
import { test } from "node:test";
import { boatWords, clockwiseWords, flockWords, scoreWords } from "../../web/doing.mjs";

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
    assert.equal(flockWords(runOf(boats), 0, { "circles-from": "0.5" }), words);
  }
});

test("several flocks are told in one short sentence, and the chosen boat by its role and direction", () => {
  const palette = { "circles-from": "0.5" };
  const runs = [{ down: 8, up: 4 }, { down: 5, outward: 7 }, { up: 12 }].map((boats) => runOf({ ...boats, leaders: 4 })).map((run) => ({ ...run, sampleAt: () => 0 }));
  assert.equal(clockwiseWords(runs, 0, palette), "Clockwise: 8, 5, 0 of 12 boats.");
  assert.equal(boatWords(runs[1], 0, 11, palette), "Boat 11: against a wall.");
  assert.equal(boatWords(runs[0], 0, 0, palette), "Boat 0, a leader: counter-clockwise.");
});

test("a score that is heard is that of this round", () => {
  const score = { children: [{ textContent: "you +0.25" }, { textContent: "" }, { textContent: "57 of 300 s. 1 round: you +0.10, the law +0.20; 0 won" }] };
  assert.equal(scoreWords(score, "1 round: you +0.10, the law +0.20; 0 won"), "you +0.25, 57 of 300 s.");
});
