// Law: a game ends when its time is up, and who has more order towards the target wins it, in the digits that are shown.

import assert from "node:assert/strict";
import { test } from "node:test";
import { verdict } from "../../web/rudder.mjs";

test("there is no verdict before the end", () => {
  assert.equal(verdict(0.5, 0.2, 119.9, 120), null);
  assert.notEqual(verdict(0.5, 0.2, 120, 120), null);
});

test("the higher order wins, and a tie is a draw", () => {
  assert.equal(verdict(0.5, -0.2, 120, 120), "You win: your order towards the target is +0.50, the law's −0.20.");
  assert.equal(verdict(-0.3, 0.25, 120, 120), "The law wins: its order towards the target is +0.25, yours −0.30.");
  assert.equal(verdict(0.2512, 0.2488, 120, 120), "A draw: you and the law both reach +0.25.");
});
