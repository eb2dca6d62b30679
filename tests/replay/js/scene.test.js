// Law: a boat is tinted by the direction in which it heads around the middle.

import assert from "node:assert/strict";
import { test } from "node:test";
import { tintOf } from "../../../flockenv/replay/shared/scene.mjs";

/** The tint of a boat east of the middle, by its heading in degrees: south is clockwise, east outward. */
const tints = (...degrees) => degrees.map((each) => tintOf([70, 0, (each * Math.PI) / 180], 0.5));

test("clockwise, counter-clockwise, and along the radius", () => {
  assert.deepEqual(tints(-90, -31, -149, 270), Array(4).fill("clockwise"));
  assert.deepEqual(tints(90, 31, 149), Array(3).fill("counter-clockwise"));
  assert.deepEqual(tints(0, 29, -29, 180, 151), Array(5).fill("radial"));
});

test("west of the middle it is the other way round", () => {
  assert.equal(tintOf([-70, 0, Math.PI / 2], 0.5), "clockwise");
});
