// Law: the page asks for what it will soon show, notes only settled flocks on the map, and ends a game.

import assert from "node:assert/strict";
import { test } from "node:test";

let frame = null;
const button = { classList: { toggle: () => undefined }, setAttribute: () => undefined };
globalThis.requestAnimationFrame = (call) => { frame = call; };
globalThis.document = { getElementById: () => button };
globalThis.performance = { now: () => 0 };
const { Playback } = await import("../../web/playback.mjs");

/** A page that plays two flocks until some time, and notes what it is asked. */
function played({ end, speed = "8", lesson, means = [0.5, 0.2], waiting = 0 }) {
  const noted = { asked: [], said: [], appended: [], map: [] };
  const run = (mean) => ({ time: [0], end, bw_s: 0.3, mean: () => mean, append: (taken, onCycle) => { noted.appended.push([taken, onCycle]); } });
  const page = {
    changing: false, other: { speed, lesson }, runs: means.map(run), hand: { value: 0.25 },
    view: { pinned: null, observed: null, map: { note: (...words) => noted.map.push(words) }, show: () => undefined },
    simulator: {
      waiting,
      ask: async (kind, question) => { noted.asked.push([kind, question]); return { taken: [{ observation: [1] }, {}], milliseconds: 1, memory: 2 }; },
      stop: (words) => noted.said.push(words),
    },
    attempt: (question) => question(), say: (words) => noted.said.push(words),
  };
  page.flocks = { runs: page.runs, areYours: lesson === "steer", isRecorded: false };
  const playback = new Playback(page);
  return { playback, page, noted, tick: async (ms) => { frame(ms); await new Promise(setImmediate); } };
}

test("it stays ahead of what it shows, by a tenth of a second and more if it plays fast", async () => {
  for (const [speed, samples] of [["1", 2], ["8", 5], ["64", 33]]) {
    const { playback, noted, tick } = played({ end: 0, speed });
    playback.restart();
    playback.toggle();
    await tick(0);
    assert.deepEqual(noted.asked.map(([kind, question]) => [kind, question.samples, question.rudder]), [["advance", samples, 0.25]]);
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

test("the map gets settled orders alone, of the first flock", async () => {
  for (const [end, isNoted] of [[20, false], [40, true]]) {
    const { playback, noted, tick } = played({ end });
    playback.restart();
    playback.toggle();
    await tick(0);
    const [[, first], [, second]] = noted.appended;
    assert.equal(first !== undefined, isNoted);
    assert.equal(second, undefined);
    first?.(0.7);
    assert.deepEqual(noted.map, isNoted ? [[0.3, 0.7]] : []);
  }
});

test("a game pauses at its end and says who won, once, and no other lesson does", async () => {
  for (const [end, lesson, sentences] of [[130, "steer", 1], [100, "steer", 0], [130, "leaders", 0]]) {
    const { playback, noted, tick } = played({ end, lesson });
    playback.restart();
    playback.toggle();
    await tick(0);
    assert.equal(noted.said.length, sentences);
    assert.equal(playback.transport.playing, sentences === 0);
    if (sentences > 0) {
      assert.match(noted.said[0], /^You win/);
      playback.toggle();
      await tick(16);
      assert.equal(noted.said.length, 1);
      assert.equal(playback.transport.playing, true);
    }
  }
});

test("a simulator without an answer is named, and pausing stops it", async () => {
  const { playback, noted, tick } = played({ end: 5, waiting: 1500 });
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

test("an answer about flocks that are no longer shown is dropped", async () => {
  const { playback, page, noted, tick } = played({ end: 0 });
  page.simulator.ask = async () => {
    page.runs = [...page.runs];
    return { taken: [{ observation: [1] }, {}], milliseconds: 1, memory: 2 };
  };
  playback.toggle();
  await tick(0);
  assert.deepEqual(noted.appended, []);
  assert.equal(page.view.observed, null);
});

test("other flocks start another round", async () => {
  const { playback, noted, tick } = played({ end: 130, lesson: "steer" });
  for (const round of [1, 2]) {
    playback.restart();
    playback.toggle();
    await tick(0);
    assert.equal(noted.said.length, round);
  }
});
