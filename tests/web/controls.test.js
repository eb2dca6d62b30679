// Law: opposed leaders are two halves, and a lesson's sentences are words and links to flocks that the page shows.

import assert from "node:assert/strict";
import { test } from "node:test";
import { opposedTargets } from "../../web/controls.mjs";
import { readLink } from "../../web/request.mjs";
import { LESSONS } from "../../web/lessons.mjs";

const FIELDS = ["n_boats", "n_leaders", "pool", "bw_s", "target"];

test("opposed leaders are two halves, the larger one clockwise", () => {
  assert.equal(opposedTargets(2), "cw,ccw");
  assert.equal(opposedTargets(3), "cw,cw,ccw");
  assert.equal(opposedTargets(4), "cw,cw,ccw,ccw");
});

test("every link of a lesson is followed whole, and stays in its lesson", () => {
  assert.equal(LESSONS.length, 5);
  for (const { name, link, words } of LESSONS) {
    const links = [link, ...Array.from(words.matchAll(/\]\((#[^)]*)\)/g), (found) => found[1])];
    for (const each of links) {
      const { ignored, other, flock } = readLink(each, FIELDS);
      assert.deepEqual(ignored, []);
      assert.equal(other.lesson, name);
      assert.equal((flock.target ?? "cw").split(",").length, flock.target ? Number(flock.n_leaders) : 1);
    }
  }
});
