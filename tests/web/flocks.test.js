// Law: a change of one field is that change, and what follows from it.

import assert from "node:assert/strict";
import { test } from "node:test";
import { changed, Flocks } from "../../web/flocks.mjs";
import { Laws } from "../../web/laws.mjs";

const values = { n_boats: "27", n_leaders: "4", target: "cw" };
const laws = new Laws([{ name: "a law at every substep" }, { name: "a law" }]);
const base = { flock: { preset: "paper", seed: "7", bw_s: "0.3" }, beside: null, copies: 1 };

test("a field changes, and what it was changed from does not", () => {
  const before = structuredClone(base);
  assert.deepEqual(changed(base, values, laws, "bw_s", "1"), { ...base, flock: { ...base.flock, bw_s: "1" } });
  assert.deepEqual(base, before);
});

test("a preset keeps boats, leaders, seed and policy alone", () => {
  const { flock } = changed({ ...base, flock: { ...base.flock, leaders: "learned" } }, values, laws, "preset", "experiment");
  assert.deepEqual(flock, { preset: "experiment", n_boats: "27", n_leaders: "4", seed: "7", leaders: "learned" });
});

test("whoever steers gets a leader, and the law beside it, which goes when nobody steers", () => {
  const yours = changed(base, { ...values, n_leaders: "0" }, laws, "leaders", "you");
  assert.equal(yours.flock.n_leaders, "1");
  assert.deepEqual(yours.beside, { leaders: "a law at every substep" });
  assert.equal(changed(base, values, laws, "leaders", "you").flock.n_leaders, undefined);
  assert.equal(changed(yours, values, laws, "leaders", "learned").beside, null);
  assert.deepEqual(changed({ ...base, beside: { n_leaders: "1" } }, values, laws, "leaders", "learned").beside, { n_leaders: "1" });
});

test("opposed targets follow the number of leaders", () => {
  assert.equal(changed(base, values, laws, "target", "opposed").flock.target, "cw,cw,ccw,ccw");
  const opposed = { ...values, target: "cw,ccw" };
  assert.equal(changed(base, opposed, laws, "n_leaders", "3").flock.target, "cw,cw,ccw");
  assert.equal(changed(base, opposed, laws, "n_leaders", "1").flock.target, "cw");
  assert.equal(changed(base, values, laws, "n_leaders", "3").flock.target, undefined);
});

test("what runs beside differs in one field, or nothing does", () => {
  assert.deepEqual(changed(base, values, laws, "beside", "n_leaders=0").beside, { n_leaders: "0" });
  assert.equal(changed({ ...base, beside: { n_leaders: "0" } }, values, laws, "beside", "").beside, null);
});

test("what already runs beside whoever steers stays", () => {
  assert.deepEqual(changed({ ...base, beside: { n_leaders: "0" } }, values, laws, "leaders", "you").beside, { n_leaders: "0" });
});

const kinds = { n_boats: "count", n_leaders: "count" };
const taken = { time_s: [0, 1], phase: [0, 0], in_analysis_window: [1, 1], pose: new Float64Array(12), velocity: new Float64Array(12), rudder: new Float64Array(2), series: [0.5, 0.5, 0.5, 0.5], contacts: new Float64Array(0) };
const answer = (target = "cw") => ({ parameters: { n_boats: 2, n_leaders: 1, bw_s: 0.3, target, discs: [], walls: [] }, lengths: {} });
const flocksOf = (ask) => new Flocks({ ask }, { kinds, laws: [{ name: "a law at every substep" }], series: ["psi_o", "signed_order"], phases: ["fw"], version: "1" });

test("flocks wait behind a recording with what they were asked before it, and come back", async () => {
  let answered;
  const flocks = flocksOf((kind) => (kind === "advance" ? new Promise((resolve) => { answered = resolve; }) :
    Promise.resolve({ continues: false, values: [answer()], taken: [taken] })));
  await flocks.update({ flock: { n_boats: "2" }, beside: null, copies: 1 }, "open");
  const { runs, values } = flocks;
  const asked = flocks.advance({});
  const recorded = [{ parameters: { n_boats: "5" } }, { parameters: { n_boats: "6" } }];
  recorded.forEach((run) => { flocks.show(run); });
  assert.deepEqual([flocks.runs, flocks.values, flocks.isRecorded], [[recorded[1]], { n_boats: "6" }, true]);
  answered({ taken: [{ ...taken, time_s: [2, 3] }] });
  await asked;
  flocks.returnToFlocks();
  assert.deepEqual([flocks.runs === runs, flocks.values === values, flocks.isRecorded], [true, true, false]);
  assert.equal(flocks.runs[0].end, 3);
});

test("what the simulator refuses is not what is asked for next", async () => {
  const flocks = flocksOf(async (kind) => {
    if (kind === "change") {
      throw new Error("refused");
    }
    return { continues: false, values: [answer()], taken: [taken] };
  });
  const first = { flock: { n_boats: "2" }, beside: null, copies: 1 };
  await flocks.update(first, "open");
  await assert.rejects(flocks.update({ ...first, flock: { n_boats: "3" } }, "change"), /refused/);
  assert.equal(flocks.requested, first);
  assert.equal(flocks.shown, first);
});

const first = { flock: { n_boats: "2", seed: "7" }, beside: null, copies: 1 };
const later = (times, inWindow = 1) => ({ ...taken, time_s: times, in_analysis_window: [inWindow, inWindow] });

/** Flocks that run two samples with each answer, and continue with each change. */
async function run(start = -1) {
  let time = start;
  const flocks = flocksOf(async (kind) => {
    time += 2;
    return { continues: kind === "change", values: [answer()], taken: [later([time - 1, time])] };
  });
  await flocks.update(first, "open");
  return flocks;
}

test("the score leaves out what was simulated before anybody looked, and a link says from when on", async () => {
  const flocks = await run();
  assert.ok(Number.isFinite(flocks.runs[0].mean("psi_o")));
  assert.deepEqual(flocks.linkFields().other, {});
  await flocks.runTo(5, () => true);
  assert.equal(flocks.runs[0].end, 5);
  flocks.restartMeans();
  assert.ok(Number.isNaN(flocks.runs[0].mean("psi_o")));
  assert.deepEqual(flocks.linkFields(), { ...first, changes: [], other: { start: "5" }, isComplete: true });
  assert.deepEqual(flocks.linkFields(5.5).other, { start: "5", now: "5.5" });
});

test("small flocks run far at once, and get no more samples than their runs keep", async () => {
  let time = 0;
  const ask = async (_, { samples = 1 }) => {
    const times = Array.from({ length: samples }, () => { time += 0.1; return time; });
    const zeros = (width) => new Float64Array(width * samples);
    const many = { ...taken, time_s: times, phase: zeros(1), in_analysis_window: zeros(1), pose: zeros(6), velocity: zeros(6), rudder: zeros(1), series: zeros(2) };
    return { continues: false, values: [answer()], taken: [many] };
  };
  const flocks = flocksOf(ask);
  await flocks.update(first, "open");
  await flocks.runTo(1500, () => true);
  assert.equal(Math.round(flocks.runs[0].end), 1500);
});

test("a flock that is not wanted any more runs no further", async () => {
  const flocks = await run();
  await flocks.runTo(50, () => flocks.runs[0].end < 9);
  assert.equal(flocks.runs[0].end, 9);
});

test("what changes on the way is in the link, with its time, and starts the score again", async () => {
  const flocks = await run();
  await flocks.update({ ...first, flock: { ...first.flock, bw_s: "0.5" } }, "change");
  await flocks.update({ ...first, flock: { seed: "7", bw_s: "0.7" } }, "change");
  const { flock, changes, other } = flocks.linkFields();
  assert.deepEqual(flock, first.flock);
  assert.deepEqual(changes, [{ time: 3, fields: { bw_s: "0.5" } }, { time: 5, fields: { n_boats: "", bw_s: "0.7" } }]);
  assert.deepEqual(other, {});
  await flocks.update(first, "open");
  assert.deepEqual(flocks.linkFields().changes, []);
});

test("more changes than a link holds are left out, and it says so", async () => {
  const flocks = await run();
  for (let k = 1; k <= 201; k += 1) {
    await flocks.update({ ...first, flock: { ...first.flock, bw_s: String(k) } }, "change");
  }
  const { flock, changes, isComplete } = flocks.linkFields();
  assert.deepEqual([flock.bw_s, changes, isComplete], ["201", undefined, false]);
});

test("a link has no time later than links may have", async () => {
  const flocks = await run(7300);
  await flocks.update({ ...first, flock: { ...first.flock, bw_s: "0.5" } }, "change");
  assert.deepEqual(flocks.linkFields(7400), { ...first, flock: { ...first.flock, bw_s: "0.5" }, other: {}, isComplete: false });
});

test("an answer about flocks that are no longer shown is dropped", async () => {
  const flocks = await run();
  const { runs } = flocks;
  const asked = flocks.advance({});
  flocks.runs = [...runs];
  await asked;
  assert.equal(runs[0].end, 1);
});

test("a map gets settled orders alone, of the first flock", async () => {
  const orders = [];
  const flocks = await run();
  for (const [times, inWindow] of [[[20, 21], 1], [[22, 23], 0], [[40, 41], 1], [[42, 43], 0]]) {
    flocks.append([later(times, inWindow)], (...order) => orders.push(order));
  }
  assert.deepEqual(orders, [[0.3, 0.5]]);
});

test("flocks of several seeds are seen, and those beside them only where nobody steers", async () => {
  const flocks = flocksOf(async (_, { requests }) => ({ continues: false, values: requests.map(() => answer()), taken: requests.map(() => taken) }));
  await flocks.update({ flock: { n_boats: "2", seed: "9", leaders: "you" }, beside: { leaders: "a law" }, copies: 3 }, "open");
  assert.deepEqual(flocks.runs.map(({ seed }) => seed), ["9", "10", "11", "9", "10", "11"]);
  assert.deepEqual([flocks.drawnRuns.length, flocks.firstBeside], [3, 3]);
  await flocks.update({ flock: { n_boats: "2" }, beside: { leaders: "a law" }, copies: 1 }, "open");
  assert.deepEqual([flocks.drawnRuns.length, flocks.firstBeside], [2, 1]);
});

test("leaders have one target or several", () => {
  const flocks = flocksOf();
  const { parameters, lengths } = answer(["cw", "ccw"]);
  const opposed = flocks.runDescription({ parameters: { ...parameters, n_leaders: 2 }, lengths }, {});
  assert.deepEqual([opposed.target, opposed.targets], [null, ["cw", "ccw"]]);
  const common = flocks.runDescription(answer("ccw"), {});
  assert.deepEqual([common.target, common.targets], ["ccw", undefined]);
});
