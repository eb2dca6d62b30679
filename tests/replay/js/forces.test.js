// Law: a bar has the area of its force, on a round scale that the page's runs share, and two bars on a boat do not meet.

import assert from "node:assert/strict";
import { test } from "node:test";
import { barOf, drawForces, forceScale } from "../../../flockenv/replay/shared/forces.mjs";
import { runOf } from "./runs.js";

const BOAT = 1.5;

test("twice the force is twice the area, less than half a boat long and at most as wide as one", () => {
  const area = (force) => barOf(force, 10, BOAT).length * barOf(force, 10, BOAT).width;
  for (const force of [3, 7, 9, 13, 29]) {
    assert.ok(Math.abs(area(2 * force) / area(force) - 2) < 1e-12, force);
  }
  assert.equal(barOf(10, 10, BOAT).length, 0.5);
  for (const force of [15, 16, 90, 1e6]) {
    assert.ok(barOf(force, 10, BOAT).length < 0.48 * BOAT);
    assert.equal(barOf(force, 10, BOAT).length, barOf(14, 10, BOAT).length);
  }
  assert.ok(barOf(15, 10, BOAT).width > barOf(14, 10, BOAT).width);
  assert.equal(barOf(1e6, 10, BOAT).width, 1);
});

test("a force too weak to be seen has no bar", () => {
  assert.equal(barOf(0.1, 10, BOAT).length, 0);
});

test("the scale is a round number near half of what nine in ten forces stay below", () => {
  const forces = Array.from({ length: 101 }, (_, k) => k);
  assert.equal(forceScale([runOf(forces)]), 50);
  assert.equal(forceScale([runOf([1, 1, 1]), runOf(forces)]), 50);
  // Of two forces the stronger one is not a typical one.
  assert.equal(forceScale([runOf([4, 400])]), 2);
});

test("there is a scale without contacts", () => {
  assert.equal(forceScale([]), 1);
  assert.equal(forceScale([runOf([])]), 1);
});

/** A canvas that records the rectangles that are drawn on it. */
function written() {
  const [rectangles, starts, turns] = [[], [], []];
  const ignore = () => undefined;
  const context = {
    save: ignore, restore: ignore, translate: (x, y) => starts.push([x, y]), rotate: (angle) => turns.push(angle),
    fillRect: (x, _y, width) => rectangles.push([context.fillStyle, x, width]),
  };
  return { context, rectangles, starts, turns };
}

test("what is drawn has the length of the force from the point where it presses, up to the longest, on each boat", () => {
  const { context, rectangles, starts, turns } = written();
  const run = runOf([6, 18, 24]);
  const scene = {
    context, run, scale: 2, poses: run.posesAt(0.5), pixel: (x, y) => [x, y],
    palette: { mark: "white", force: "red" },
  };
  drawForces(scene, 1, 6);
  const bars = rectangles.filter(([color]) => color === "red");
  // A hull of radius 5 cm at 2 pixels a cm is 20 pixels wide; two boats are pushed, then one by a wall.
  assert.deepEqual(bars, [["red", 0, 10], ["red", 0, 10], ["red", 0, 18]]);
  // Boats at (10, 4) and (30, 0) are pushed eastward, each where its hull ends in the west.
  assert.deepEqual(starts, [[5, 4], [5, 4], [25, 0]]);
  assert.deepEqual(turns.map(Math.abs), [0, Math.PI, 0]);
});
