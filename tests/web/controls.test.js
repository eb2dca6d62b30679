// Law: opposed leaders are two halves, leaders with policies of their own have one each, and a lesson's sentences are words and links to flocks that the page shows.

import assert from "node:assert/strict";
import { test } from "node:test";
import { opposedTargets } from "../../web/controls.mjs";
import { Laws } from "../../web/laws.mjs";
import { readLink } from "../../web/request.mjs";
import { LESSONS, OPENING, wordsOf } from "../../web/lessons.mjs";

const FIELDS = ["n_boats", "n_leaders", "pool", "bw_s", "target"];

test("opposed leaders are two halves, the larger one clockwise", () => {
  assert.equal(opposedTargets(2), "cw,ccw");
  assert.equal(opposedTargets(3), "cw,cw,ccw");
  assert.equal(opposedTargets(4), "cw,cw,ccw,ccw");
});

const laws = new Laws(["paper's law at every substep", "paper's law", "tuned law", "learned"].map((name) => ({ name })));

test("laws that differ only in how often they act are offered once for all leaders, and each for one of them", () => {
  assert.deepEqual(laws.sharedChoices, ["paper's law at every substep", "tuned law", "learned", "trained", "you"]);
  assert.deepEqual(laws.sharedChoices.map((name) => laws.words(name)), ["the paper's law", "the tuned law", "learned steering", "what you trained", "you"]);
  assert.deepEqual(laws.leaderChoices, ["paper's law", "tuned law", "learned"]);
});

test("each leader has a policy, the last one's if no other is known", () => {
  assert.equal(laws.policiesFor("paper's law at every substep", 3), "paper's law,paper's law,paper's law");
  assert.equal(laws.policiesFor("learned,tuned law", 3), "learned,tuned law,tuned law");
  assert.equal(laws.policiesFor("learned,tuned law", 1), "learned");
  assert.equal(laws.policiesFor("you", 2), "paper's law,paper's law");
});

test("a lesson has a short sentence or two before and after, and so has the opening", () => {
  for (const each of [...LESSONS, wordsOf("")]) {
    const { before, after } = wordsOf(each.name ?? "");
    for (const words of [before, after].map((text) => text.replace(/\]\([^)]*\)/g, ""))) {
      assert.ok(words.split(" ").length <= 27, words);
      assert.match(words, /\.$/);
    }
    assert.deepEqual(wordsOf(each.name ?? ""), each);
  }
});

test("every link of a lesson is followed whole, and stays in its lesson", () => {
  assert.equal(LESSONS.length, 7);
  assert.equal(LESSONS[0].name, "steer");
  assert.deepEqual(readLink(OPENING, FIELDS).ignored, []);
  for (const { name, link, before, after } of LESSONS) {
    const links = [link, ...Array.from(`${before} ${after}`.matchAll(/\]\((#[^)]*)\)/g), (found) => found[1])];
    for (const each of links) {
      const { ignored, other, flock } = readLink(each, FIELDS);
      assert.deepEqual(ignored, []);
      assert.equal(other.lesson, name);
      assert.equal((flock.target ?? "cw").split(",").length, flock.target ? Number(flock.n_leaders) : 1);
    }
  }
});
