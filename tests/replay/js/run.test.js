// Law: a run says what the recording says at a sample, and straight lines in between.

import assert from "node:assert/strict";
import { test } from "node:test";
import { boatNumbers } from "../../../flockenv/replay/shared/panel.mjs";
import { Run, span } from "../../../flockenv/replay/shared/run.mjs";
import { column, runOf } from "./runs.js";

test("the last sample at or before a time", () => {
  const run = runOf();
  assert.deepEqual([-1, 0, 0.4, 0.5, 0.9, 1, 7].map((time) => run.sampleAt(time)), [0, 0, 0, 1, 1, 2, 2]);
});

test("a time that is a rounding before a sample is that sample", () => {
  assert.equal(runOf().sampleAt(0.5 - 1e-12), 1);
});

test("the next sample may be the first one, and after the last one there is none", () => {
  assert.deepEqual([-1, 0, 0.4, 0.5 - 1e-12, 0.5, 1].map((time) => runOf().timeAfter(time)), [0, 0.5, 0.5, 1, 1, Infinity]);
});

test("before the first sample poses are those of the first", () => {
  assert.deepEqual(runOf().posesAt(-1), runOf().posesAt(0));
});

test("poses between samples lie on straight lines", () => {
  const run = runOf();
  assert.deepEqual(run.posesAt(0), [[0, 0, 0], [30, 0, 1]]);
  assert.deepEqual(run.posesAt(0.25), [[5, 2, 0.25], [30, 0, 1]]);
  assert.deepEqual(run.posesAt(99), [[20, 8, 1], [30, 0, 1]]);
});

test("a tracked boat that is not there has no pose and no card, and has its own name", () => {
  const run = runOf();
  run.columns.set("present", column([1, 1, 1, 1, 0, 1], 1, 2));
  run.ids = ["red", "blue"];
  assert.deepEqual(run.posesAt(0)[1], [30, 0, 1]);
  assert.deepEqual(run.posesAt(0.6)[1], [NaN, NaN, NaN]);
  assert.equal(run.isPresent(1, 1), false);
  assert.equal(run.isPresent(0, 1), true);
  assert.equal(run.nameOf(1), "blue");
  assert.equal(runOf().nameOf(1), "boat 1");
  assert.equal(runOf().isPresent(1, 1), true);
});

test("contacts belong to their sample", () => {
  const run = runOf();
  assert.deepEqual(run.contacts(0), []);
  assert.deepEqual(run.contacts(1).map(({ i, j, force }) => [i, j, force]), [[0, 1, 5], [1, -1, 20]]);
  assert.deepEqual(run.contacts(2).map(({ force }) => force), [40]);
});

test("only leaders have a rudder and an orientation", () => {
  const run = runOf();
  assert.equal(run.rudder(0, 1), 0.5);
  assert.equal(run.orientation(0, 1), 1.5);
  assert.equal(run.rudder(1, 1), undefined);
});

test("a leader's card reports its rudder and its angle, a normal boat's does not", () => {
  const reported = (boat) => Object.fromEntries(boatNumbers(runOf(), boat, 1).map(([name, value]) => [name, value]));
  assert.equal(reported(0).rudder, "+0.50");
  assert.equal(reported(0).φ, "+1.50");
  assert.equal(reported(0).contacts, "1");
  assert.equal(reported(1)["strongest push"], "20.0");
  assert.equal(reported(1).rudder ?? reported(1).φ, undefined);
});

test("a recording without rudders or contacts leaves them open", () => {
  const full = runOf();
  const columns = new Map([...full.columns].filter(([name]) => !/contact|rudder/.test(name)));
  const run = new Run({ boats: 2, leaders: 1, phases: ["fw"] }, columns);
  assert.equal(run.hasForces, false);
  assert.deepEqual(run.contacts(1), []);
  const reported = Object.fromEntries(boatNumbers(run, 0, 1));
  assert.equal(reported.rudder, "–");
  assert.ok(!("contacts" in reported));
});

test("a value is that of the sample, and undefined where there is no such series", () => {
  assert.equal(runOf().value("psi_o", 2), 0.75);
  assert.equal(runOf().value("milling", 2), undefined);
});

test("a mean so far is that of the analysis windows, or of all samples where there is none", () => {
  const run = runOf();
  assert.ok(Number.isNaN(run.meanUpTo("psi_o", 0)));
  assert.deepEqual([1, 2].map((sample) => run.meanUpTo("psi_o", sample)), [0.5, 0.5]);
  assert.equal(run.meanUpTo("nothing", 2), undefined);
  const tracks = runOf();
  tracks.phases = [];
  assert.deepEqual([0, 1, 2].map((sample) => tracks.meanUpTo("psi_o", sample)), [0.25, 0.375, 0.5]);
});

test("runs together start with the first and end with the last", () => {
  const later = runOf();
  later.time = Float64Array.of(2, 3, 4);
  assert.deepEqual(span([runOf(), later]), [0, 4]);
});

test("a column is channel after channel, in quanta", () => {
  const each = column([1, 2, 3, 4], 0.5, 2);
  assert.deepEqual([each.at(0), each.at(1), each.at(0, 1), each.at(1, 1)], [0.5, 1, 1.5, 2]);
});

test("a counter-clockwise leader is an opponent where leaders head against each other", () => {
  const [one, both] = [new Run({ boats: 3, leaders: 2 }, runOf().columns), runOf()];
  assert.deepEqual([0, 1, 2].map((boat) => one.roleOf(boat)), ["leader", "leader", "normal"]);
  Object.assign(both, { boats: 3, leaders: 2, targets: ["cw", "ccw"] });
  assert.deepEqual([0, 1, 2].map((boat) => both.roleOf(boat)), ["leader", "opponent", "normal"]);
});
