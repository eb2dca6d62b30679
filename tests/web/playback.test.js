// Law: the page asks for what it will soon show, waits while flocks become others, and ends the rounds of a game.

import assert from "node:assert/strict";
import { test } from "node:test";

let frame = null;
const button = { textContent: "", classList: { toggle: () => undefined }, setAttribute: () => undefined };
globalThis.requestAnimationFrame = (call) => { frame = call; };
globalThis.document = { getElementById: () => button };
globalThis.performance = { now: () => 0 };
const { Playback } = await import("../../web/playback.mjs");

/** A page that plays two flocks until some time, and notes what it is asked. */
function played({ end, speed = "8", lesson, means = [0.5, 0.2], waiting = 0 }) {
  const noted = { asked: [], said: [], map: [], again: 0, links: 0 };
  const run = (mean) => ({ time: [0], end, bw_s: 0.3, mean: () => mean });
  const page = {
    changing: false, other: { speed, lesson }, runs: means.map(run), helm: { value: 0.25, center: () => undefined },
    view: { panels: [{}], pinned: null, observed: null, map: { note: (...words) => noted.map.push(words) }, show: () => undefined },
    simulator: { waiting, stop: (words) => noted.said.push(words) },
    attempt: (question) => question(), say: (words) => noted.said.push(words),
    again: async () => { noted.again += 1; }, link: { write: () => { noted.links += 1; } },
  };
  page.flocks = {
    runs: page.runs, firstBeside: 1, areYours: lesson === "steer", isRecorded: false, shown: { flock: {} },
    advance: async (question, onCycle) => {
      noted.asked.push(question);
      onCycle(0.3, 0.7);
      return { taken: [{ observation: [1] }, {}], milliseconds: 1, memory: 2 };
    },
  };
  const playback = new Playback(page);
  return { playback, page, noted, tick: async (ms) => { frame(ms); await new Promise(setImmediate); } };
}

test("it stays ahead of what it shows, by a tenth of a second and more if it plays fast", async () => {
  for (const [speed, samples] of [["1", 2], ["8", 5], ["64", 33]]) {
    const { playback, noted, tick } = played({ end: 0, speed });
    playback.restart();
    playback.toggle();
    await tick(0);
    assert.deepEqual(noted.asked.map((question) => [question.samples, question.heading]), [[samples, 0.25]]);
    assert.deepEqual(noted.map, [[0.3, 0.7]]);
  }
});

test("it shows no more than there is, at its speed", async () => {
  const { playback, page, tick } = played({ end: 1, speed: "2" });
  playback.toggle();
  await tick(200);
  assert.ok(Math.abs(playback.time - 0.4) < 1e-9);
  await tick(5_000_000);
  // A page that was in the background goes on where it was: a quarter of a second counts.
  assert.ok(Math.abs(playback.time - 0.9) < 1e-9);
  await tick(5_000_250);
  assert.equal(playback.time, page.runs[0].end);
});

test("nothing moves while the flocks become others", async () => {
  const { playback, page, noted, tick } = played({ end: 5 });
  playback.toggle();
  page.changing = true;
  await tick(200);
  assert.deepEqual([playback.time, noted.asked.length], [0, 0]);
});

test("a round pauses at its end and is counted, once, and no other lesson's flock is", async () => {
  for (const [end, lesson, sentences] of [[310, "steer", 1], [299, "steer", 0], [310, "leaders", 0]]) {
    const { playback, noted, tick } = played({ end, lesson });
    playback.restart();
    playback.toggle();
    await tick(0);
    assert.equal(noted.said.length, sentences);
    assert.equal(playback.transport.playing, sentences === 0);
    assert.equal(playback.isOver, sentences === 1);
    if (sentences > 0) {
      assert.match(noted.said[0], /^Round 1: you lead better, /);
      // A hand that moves does not go on, and the button starts another round.
      playback.start();
      assert.deepEqual([playback.transport.playing, noted.again], [false, 0]);
      playback.toggle();
      await tick(16);
      assert.deepEqual([noted.said.length, noted.again], [1, 1]);
    }
  }
});

test("a hand that moves starts a round that waits, and nobody else's flock", () => {
  for (const lesson of ["steer", "leaders"]) {
    const { playback } = played({ end: 5, lesson });
    playback.start();
    assert.equal(playback.transport.playing, lesson === "steer");
    playback.start();
    assert.equal(playback.transport.playing, lesson === "steer");
  }
});

test("a simulator without an answer is named, and pausing stops it", async () => {
  const { playback, noted, tick } = played({ end: 5, waiting: 1500 });
  playback.costs.simulating = 1;
  playback.toggle();
  await tick(0);
  assert.match(noted.said[0], /pause stops it/);
  playback.toggle();
  assert.match(noted.said.at(-1), /you stopped it/);
});

test("time is sought within what there is", () => {
  const { playback, page } = played({ end: 5 });
  page.runs[0].time = [2];
  assert.deepEqual([-1, 3, 9].map((time) => { playback.seek(time); return playback.time; }), [2, 3, 5]);
});

test("pausing writes the moment into the link", () => {
  const { playback, noted } = played({ end: 5 });
  playback.toggle();
  assert.equal(noted.links, 0);
  playback.toggle();
  assert.equal(noted.links, 1);
});

test("a slow first answer does not count as a missing one", async () => {
  const { playback, noted, tick } = played({ end: 5, waiting: 1500 });
  playback.toggle();
  await tick(0);
  assert.deepEqual(noted.said, []);
});

test("other flocks start another round", async () => {
  const { playback, noted, tick } = played({ end: 310, lesson: "steer" });
  for (const round of [1, 2]) {
    playback.restart();
    playback.toggle();
    await tick(0);
    assert.equal(noted.said.length, round);
  }
});

test("a round waits for the visitor, and so does a still picture; what comes after them plays on", () => {
  let isLess = false;
  globalThis.matchMedia = () => ({ matches: isLess });
  const { playback, page } = played({ end: 0, lesson: "steer" });
  playback.transport.play();
  playback.hold(false);
  assert.equal(playback.transport.playing, false);
  playback.start();
  assert.equal(playback.transport.playing, true);
  for (const [lesson, isStill, plays] of [["steer", false, false], ["noise", false, true], ["forces", true, false], ["noise", false, true]]) {
    Object.assign(page.other, { lesson });
    page.flocks.areYours = lesson === "steer";
    playback.hold(isStill);
    assert.equal(playback.transport.playing, plays, lesson);
  }
  // What the visitor paused stays so, and what the page paused does where the system asks for less motion.
  playback.hold(true);
  playback.toggle();
  playback.toggle();
  playback.hold(false);
  assert.equal(playback.transport.playing, false);
  playback.hold(true);
  isLess = true;
  playback.hold(false);
  assert.equal(playback.transport.playing, false);
});

test("a round that is over holds the page until the next lesson plays", async () => {
  globalThis.matchMedia = () => ({ matches: false });
  const { playback, page, tick } = played({ end: 300, lesson: "steer" });
  playback.restart();
  playback.start();
  await tick(0);
  assert.deepEqual([playback.isOver, playback.transport.playing], [true, false]);
  page.other.lesson = "noise";
  playback.hold(false);
  assert.equal(playback.transport.playing, true);
});

test("a round that waits behind a recording goes on where it was", async () => {
  for (const plays of [true, false]) {
    const { playback, page, noted, tick } = played({ end: 57, lesson: "steer" });
    let centered = 0;
    page.helm.center = () => { centered += 1; };
    page.showRuns = () => undefined;
    const { runs } = page;
    Object.assign(page.flocks, {
      show: (run) => { page.runs = [run]; Object.assign(page.flocks, { runs: page.runs, isRecorded: true, areYours: false }); },
      returnToFlocks: () => { page.runs = runs; Object.assign(page.flocks, { runs, isRecorded: false, areYours: true }); },
    });
    playback.restart();
    page.view.pinned = 3;
    if (plays) {
      playback.toggle();
    }
    playback.time = 56.5;
    for (const time of [0, 1]) {
      playback.begin({ time: [time], end: 4 });
      assert.deepEqual([playback.time, playback.transport.playing], [time, false]);
    }
    page.view.pinned = null;
    playback.toggle();
    await tick(16);
    playback.returnToFlocks();
    assert.deepEqual([playback.time, playback.transport.playing, centered, page.view.pinned], [56.5, plays, 1, 3]);
    assert.deepEqual([noted.again, noted.said], [0, [""]]);
  }
});
