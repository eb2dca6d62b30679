// Law: a link is followed where it can be, and what cannot be followed is named.

import assert from "node:assert/strict";
import { test } from "node:test";
import { linkTo, readLink } from "../../../flockenv/replay/link.mjs";
import { Run } from "../../../flockenv/replay/shared/run.mjs";

const PAGE = { start: 0, end: 480, speeds: [0.5, 1, 8] };

test("a time and a speed", () => {
  assert.deepEqual(readLink("#t=240&speed=8", PAGE), { time: 240, speed: 8, ignored: [] });
  assert.deepEqual(readLink("#speed=0.5", PAGE), { time: null, speed: 0.5, ignored: [] });
  assert.deepEqual(readLink("", PAGE), { time: null, speed: null, ignored: [] });
});

test("both ends of the run are times of it", () => {
  assert.equal(readLink("#t=0", PAGE).time, 0);
  assert.equal(readLink("#t=480", PAGE).time, 480);
});

for (const text of ["-1", "480.1", "NaN", "Infinity", "", " ", "soon", "2,5"]) {
  test(`the time "${text}" is ignored in words, and the speed beside it is not`, () => {
    const { time, speed, ignored } = readLink(`#t=${text}&speed=1`, PAGE);
    assert.equal(time, null);
    assert.equal(speed, 1);
    assert.deepEqual(ignored, [`The link's t=${text} is ignored: t is a time from 0 to 480 s.`]);
  });
}

test("a speed that the page does not have is ignored in words", () => {
  const { speed, ignored } = readLink("#speed=3", PAGE);
  assert.equal(speed, null);
  assert.deepEqual(ignored, ["The link's speed=3 is ignored: speed is one of 0.5, 1, 8."]);
});

test("other words are ignored in words, long ones cut", () => {
  assert.match(readLink("#boats", PAGE).ignored[0], /^The link's boats= is ignored: a link may hold/);
  const long = readLink(`#t=${"9".repeat(1000)}`, PAGE).ignored[0];
  assert.ok(long.length < 120);
});

test("what is written is read back", () => {
  assert.equal(linkTo(240, 8), "#t=240&speed=8");
  assert.equal(linkTo(12.3000001, 0.5), "#t=12.3&speed=0.5");
  assert.deepEqual(readLink(linkTo(479.9, 8), PAGE), { time: 479.9, speed: 8, ignored: [] });
});

test("a link to a sample of tracks, at 30 frames per second, shows that sample, the last one too", () => {
  const times = Float64Array.from({ length: 1001 }, (_, k) => k / 30);
  const run = new Run({}, new Map(), times);
  for (const k of [0, 1, 299, 300, 1000]) {
    const { time, ignored } = readLink(linkTo(times[k], 8), { ...PAGE, end: times.at(-1) });
    assert.deepEqual([run.sampleAt(time), ignored], [k, []]);
  }
});
