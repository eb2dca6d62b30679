// Law: a boat's local frame points outward and clockwise, and its angle lies between the heading and the outward axis.

import assert from "node:assert/strict";
import { test } from "node:test";
import { drawLapFrame } from "../../web/lap_frame.mjs";
import { canvas } from "./pictures.js";

/** Where words stand, from the boat in the middle of a large canvas, with y upward. */
function words(pose) {
  const picture = canvas(800, 800);
  drawLapFrame({ context: picture.getContext(), canvas: picture, palette: {}, scale: 10, poses: [pose], place: () => [400, 400], run: { lengths: { hull_radius_cm: 5 } } }, 0);
  return Object.fromEntries(picture.calls.filter(({ name }) => name === "fillText").map(({ words: [text, x, y] }) => [text, [x, -y]]));
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
