// Law: arrow keys and the thumb set the heading of the leaders, clockwise to the right, and it stays.

import assert from "node:assert/strict";
import { test } from "node:test";
import { headingWords, Helm } from "../../web/helm.mjs";

/** A helm on a page that has nothing else: what it hears, and its thumb. */
function helmOf(isYours = true) {
  const heard = {};
  const said = { textContent: "" };
  const thumb = {
    value: 0, focus: () => undefined, addEventListener: (name, call) => { heard[`thumb ${name}`] = call; },
    setAttribute: (name, value) => { thumb[name] = value; },
  };
  globalThis.document = { addEventListener: (name, call) => { heard[name] = call; }, querySelector: () => null };
  let turns = 0;
  const helm = new Helm(thumb, said, () => isYours, () => { turns += 1; });
  const press = (key, more = {}) => heard.keydown({ key, target: {}, preventDefault: () => undefined, stopPropagation: () => undefined, ...more });
  return { helm, thumb, said, press, heard, turns: () => turns };
}

test("it starts straight at the wall, and each key turns by 15 degrees, around and around", () => {
  const { helm, thumb, said, press, turns } = helmOf();
  assert.deepEqual([helm.value, said.textContent, turns()], [0, "straight at the wall", 0]);
  press("ArrowRight");
  assert.deepEqual([helm.value, thumb.value, turns()], [15 / 180, 15, 1]);
  press("ArrowLeft");
  press("ArrowLeft");
  assert.equal(thumb.value, -15);
  for (let k = 0; k < 13; k += 1) {
    press("ArrowRight");
  }
  assert.deepEqual([helm.value, thumb["aria-valuetext"]], [1, "straight inward"]);
  press("ArrowRight");
  assert.deepEqual([thumb.value, said.textContent], [-165, "counter-clockwise, 75° inward"]);
  press("ArrowLeft");
  assert.equal(thumb.value, -180);
  helm.center();
  assert.deepEqual([helm.value, said.textContent], [0, "straight at the wall"]);
});

test("it is turned neither where there is nobody to steer, nor with another key held", () => {
  const idle = helmOf(false);
  idle.press("ArrowRight");
  assert.equal(idle.helm.value, 0);
  const { helm, press, heard, thumb, turns } = helmOf();
  press("ArrowRight", { ctrlKey: true });
  press("x");
  assert.deepEqual([helm.value, turns()], [0, 0]);
  thumb.value = "90";
  heard["thumb input"]();
  assert.deepEqual([helm.value, turns()], [0.5, 1]);
});

test("a heading in words", () => {
  const words = Object.fromEntries([0, 15, 90, 105, 180, -75, -90, -165].map((degrees) => [degrees, headingWords(degrees)]));
  assert.deepEqual(words, {
    0: "straight at the wall", 15: "clockwise, 75° outward", 90: "clockwise", 105: "clockwise, 15° inward", 180: "straight inward",
    "-75": "counter-clockwise, 15° outward", "-90": "counter-clockwise", "-165": "counter-clockwise, 75° inward",
  });
});
