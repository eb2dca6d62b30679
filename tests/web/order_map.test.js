// Law: the map shows each mean order at its backward duration, over the order that is expected of this very flock.

import assert from "node:assert/strict";
import { test } from "node:test";
import { MOST_NOISE, OrderMap } from "../../web/order_map.mjs";
import { canvas } from "./pictures.js";

const ORDERS = [{ preset: "experiment", n_boats: 27, n_leaders: 0, points: [[0, 1], [MOST_NOISE, 0]] }];
const PALETTE = { water: "water", normal: "normal", faint: "faint", leader: "leader", outline: "outline" };
const [EXPECTED, OTHER] = [{ preset: "experiment", n_boats: "27", seed: "6", bw_s: "0.8" }, { n_boats: "27" }];
const WIDTH = 338;
const HEIGHT = 136;

function drawn(notes, flock = EXPECTED) {
  const picture = canvas(WIDTH, HEIGHT);
  const map = new OrderMap(picture, ORDERS);
  map.expect(flock, "one");
  for (const [noise, order] of notes) {
    map.note(noise, order);
  }
  map.draw(PALETTE);
  return { map, picture, dots: picture.calls.filter(({ name }) => name === "arc"), marks: picture.calls.filter(({ name, fill }) => name === "fillRect" && fill === "normal") };
}

test("the dot is at the last order, and order points up", () => {
  const { dots } = drawn([[0, 0], [MOST_NOISE, 1]]);
  // 300 × 100 pixels, 30 from the left and 6 from the top.
  assert.deepEqual(dots[0].words.slice(0, 2), [330, 6]);
  assert.deepEqual(drawn([[MOST_NOISE / 2, 0.25]]).dots[0].words.slice(0, 2), [180, 81]);
});

test("a mark stays where the flock was, but for noise beyond the map", () => {
  const { marks } = drawn([[0, 0], [0, 0.001], [MOST_NOISE + 1, 0.5], [MOST_NOISE / 2, 0.99]]);
  assert.deepEqual(marks.map(({ words }) => words.slice(0, 2)), [[30, 102], [180, 6]]);
});

test("the expected line is that of the same flock alone, whatever its seed and noise", () => {
  const lines = ({ picture }) => picture.calls.filter(({ name }) => name === "lineTo").map(({ words }) => words);
  assert.deepEqual(lines(drawn([])), [[30, 6], [330, 106]]);
  for (const flock of [OTHER, { ...EXPECTED, n_boats: "20" }, { ...EXPECTED, n_leaders: "3" }, { ...EXPECTED, pool: "wide" }, { ...EXPECTED, c4: "0.1" }]) {
    assert.deepEqual(lines(drawn([], flock)), []);
  }
});

test("a map with nothing on it is hidden, and another flock starts an empty one", () => {
  const { map, picture } = drawn([], OTHER);
  assert.equal(picture.figure.hidden, true);
  map.note(1, 0.5);
  assert.equal(picture.figure.hidden, false);
  map.expect(OTHER, "one");
  assert.equal(map.counts.reduce((sum, each) => sum + each), 1);
  map.expect(OTHER, "another");
  assert.equal(map.counts.reduce((sum, each) => sum + each), 0);
  assert.equal(picture.figure.hidden, true);
  map.expect(EXPECTED, "a third");
  assert.equal(picture.figure.hidden, false);
  map.expect(null, "a recording");
  assert.equal(picture.figure.hidden, true);
});
