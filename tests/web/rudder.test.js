// Law: a game ends when its time is up, and who has more order towards the target wins it, in the digits that are shown.

import assert from "node:assert/strict";
import { test } from "node:test";
import { Rudder, verdict } from "../../web/rudder.mjs";

test("there is no verdict before the end", () => {
  assert.equal(verdict(0.5, 0.2, 119.9, 120), null);
  assert.notEqual(verdict(0.5, 0.2, 120, 120), null);
});

test("the higher order wins, and a tie is a draw", () => {
  assert.equal(verdict(0.5, -0.2, 120, 120), "You win: your order towards the target is +0.50, the law's −0.20.");
  assert.equal(verdict(-0.3, 0.25, 120, 120), "The law wins: its order towards the target is +0.25, yours −0.30.");
  assert.equal(verdict(0.2512, 0.2488, 120, 120), "A draw: you and the law both reach +0.25.");
});

test("keys that are held turn the rudder, and are let go of with the page", () => {
  const heard = {};
  const target = { addEventListener: (name, call) => { heard[name] = call; } };
  Object.assign(globalThis, { window: { ...target }, document: { ...target, querySelector: () => null } });
  globalThis.window.addEventListener = (name, call) => { heard[`window ${name}`] = call; };
  const thumb = { value: 0, addEventListener: () => undefined, focus: () => undefined };
  const rudder = new Rudder(thumb, () => true);
  const press = (type, key) => heard[type]({ type, key, target: {}, preventDefault: () => undefined, stopPropagation: () => undefined });
  press("keydown", "ArrowLeft");
  assert.deepEqual([rudder.value, thumb.value], [1, -1]);
  heard["window blur"]();
  assert.equal(rudder.value, 0);
  // The key came up while another page was in front.
  press("keydown", "ArrowRight");
  assert.equal(rudder.value, -1);
});
