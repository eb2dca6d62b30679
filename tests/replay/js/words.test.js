// Law: numbers are written with the given digits, a real minus sign, and no sign on a zero.

import assert from "node:assert/strict";
import { test } from "node:test";
import { caption, clockText, fixed, plain, roundNumber, withSign, wrapped } from "../../../flockenv/replay/shared/words.mjs";

test("numbers with a fixed number of decimals", () => {
  assert.equal(fixed(1.25, 1), "1.3");
  assert.equal(fixed(-1.5, 2), "−1.50");
  assert.equal(withSign(0.5, 2), "+0.50");
  assert.equal(withSign(-0.001, 2), "0.00");
  assert.equal(fixed(undefined, 2), "–");
  assert.equal(fixed(Number.NaN, 2), "–");
});

test("numbers as short as they are", () => {
  assert.equal(plain(-0.5), "−0.5");
  assert.equal(plain(0.1 + 0.2), "0.3");
});

test("angles are wrapped to within half a turn", () => {
  assert.ok(Math.abs(wrapped(7) - (7 - 2 * Math.PI)) < 1e-12);
  assert.ok(Math.abs(wrapped(-4) - (2 * Math.PI - 4)) < 1e-12);
});

test("times of an axis", () => {
  assert.deepEqual([5, 59, 60, 75, 3600].map(clockText), ["5 s", "59 s", "1:00", "1:15", "60:00"]);
});

test("a quantity with and without a unit", () => {
  assert.equal(caption({ words: "velocity", unit: "cm/s" }), "velocity (cm/s)");
  assert.equal(caption({ words: "order", unit: "" }), "order");
});

test("the next of 1, 2, 5 and 10 times a power of ten", () => {
  assert.deepEqual([0.3, 1, 1.1, 3, 6, 10, 99].map(roundNumber), [0.5, 1, 2, 5, 10, 10, 100]);
  // A rounding above a round number is that number.
  assert.equal(roundNumber(2 * (1 + 1e-12)), 2);
});
