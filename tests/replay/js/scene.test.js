// Law: a boat is tinted by the direction in which it heads around the middle.

import assert from "node:assert/strict";
import { test } from "node:test";
import { giveColors, Scene, tintOf } from "../../../flockenv/replay/shared/scene.mjs";

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

/** The colors of runs [name, law, leaders]. */
const given = (...runs) => {
  const described = runs.map(([name, law, leaders = 3]) => ({ name, law, leaders }));
  giveColors(described);
  return described.map(({ color }) => color);
};

test("a run has the color of its law, whatever it is called and wherever it stands", () => {
  assert.deepEqual(given(["a", "paper's law at every substep"], ["b", "learned"]), ["paper-law", "learned"]);
  assert.deepEqual(given(["b", "learned"], ["a", "tuned law"]), ["learned", "tuned-law"]);
});

test("others have colors of no law, and no two runs the same", () => {
  assert.deepEqual(given(["a", "mine"], ["b", null]), ["run-1", "run-2"]);
  assert.deepEqual(given(["a", "paper's law"], ["b", "paper's law"]), ["paper-law", "run-1"]);
  assert.deepEqual(given(["a", "paper's law", 0], ["b", "paper's law,learned"]), ["run-1", "run-2"]);
});

test("copies of a flock have its color", () => {
  assert.deepEqual(given(["you", "you"], ["you", "you"], ["the law", "paper's law"]), ["run-1", "run-1", "paper-law"]);
});

/** A picture of a run of one boat at a pose; what is drawn calls the functions in `drawing`. */
function sceneOf(drawing, pose, outer) {
  globalThis.window = {};
  const context = new Proxy(drawing, { get: (_, name) => drawing[name] ?? (() => undefined), set: () => true });
  const canvas = { clientWidth: 200, clientHeight: 200, getContext: () => context };
  const lengths = { outer_radius_cm: outer, inner_radius_cm: 0, hull_radius_cm: 4, hull_half_length_cm: 6 };
  return new Scene(canvas, { lengths, boats: 1, leaders: 0, walls: [], discs: [], hasForces: false, posesAt: () => [pose], roleOf: () => "normal" });
}

test("a boat that another run has is marked in that run alone", () => {
  const radii = [];
  const scene = sceneOf({ arc: (...numbers) => radii.push(numbers[2]) }, [70, 0, 0], 90);
  const drawn = (boat) => {
    radii.length = 0;
    scene.draw(0, { trailSeconds: 0, forceScale: null, boat, coloring: "role", palette: {} });
    return radii.length;
  };
  assert.equal(drawn(1), drawn(null));
  assert.equal(drawn(0), drawn(null) + 1);
});

test("open water has few lines, though no boat is there", () => {
  let lines = 0;
  const moveTo = () => {
    lines += 1;
    assert.ok(lines < 100);
  };
  sceneOf({ moveTo }, [NaN, NaN, NaN], null).draw(0, { trailSeconds: 0, forceScale: null, boat: null, coloring: "role", palette: {} });
  assert.ok(lines > 0);
});
