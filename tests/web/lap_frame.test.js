// Law: a boat's local frame points outward and clockwise, and its angle lies between the heading and the outward axis.

import assert from "node:assert/strict";
import { test } from "node:test";
import { drawLapFrame } from "../../web/lap_frame.mjs";
import { canvas } from "./pictures.js";

test("the arc goes from the outward axis to the heading, the short way", () => {
  // A canvas turns clockwise, with y downward, unless it is told otherwise.
  for (const [heading, isCounter] of [[0.6, true], [-0.6, false]]) {
    const [, , , from, to, flag] = drawn([70, 0, heading]).find(({ name }) => name === "arc").words;
    assert.ok(Math.abs(from) < 1e-9 && Math.abs(to + heading) < 1e-9);
    assert.equal(flag, isCounter);
  }
});

/** Where words stand, from the boat in the middle of a large canvas, with y upward. */
function words(pose) {
  return Object.fromEntries(drawn(pose).filter(({ name }) => name === "fillText").map(({ words: [text, x, y] }) => [text, [x, -y]]));
}

function drawn(pose) {
  const picture = canvas(800, 800);
  drawLapFrame({ context: picture.getContext(), canvas: picture, palette: {}, scale: 10, poses: [pose], pixelOf: () => [400, 400], run: { lengths: { hull_radius_cm: 5 } } }, 0);
  return picture.calls;
}

test("east of the middle outward is east, and clockwise is south", () => {
  const { outward, clockwise } = words([70, 0, 0]);
  assert.ok(outward[0] > 200 && Math.abs(outward[1]) < 1);
  assert.ok(clockwise[1] < -200 && Math.abs(clockwise[0]) < 1);
});

test("the angle's name is halfway from the heading to the outward axis", () => {
  for (const heading of [-Math.PI / 2, Math.PI / 2, 0.6]) {
    const [x, y] = words([70, 0, heading]).φ;
    assert.ok(Math.abs(Math.atan2(y, x) - heading / 2) < 1e-9, String(heading));
  }
});
