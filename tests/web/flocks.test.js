// Law: a change of one field is that change, and what follows from it.

import assert from "node:assert/strict";
import { test } from "node:test";
import { changed, Flocks } from "../../web/flocks.mjs";
import { Laws } from "../../web/laws.mjs";

const values = { n_boats: "27", n_leaders: "4", target: "cw" };
const laws = new Laws([{ name: "a law at every substep" }, { name: "a law" }]);
const base = { flock: { preset: "paper", seed: "7", bw_s: "0.3" }, beside: null };

test("a field changes, and what it was changed from does not", () => {
  const before = structuredClone(base);
  assert.deepEqual(changed(base, values, laws, "bw_s", "1"), { flock: { ...base.flock, bw_s: "1" }, beside: null });
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

test("what the simulator refuses is not what is asked for next", async () => {
  const flocks = flocksOf(async (kind) => {
    if (kind === "change") {
      throw new Error("refused");
    }
    return { continues: false, values: [answer()], taken: [taken] };
  });
  const first = { flock: { n_boats: "2" }, beside: null };
  await flocks.become(first, "open");
  await assert.rejects(flocks.become({ flock: { n_boats: "3" }, beside: null }, "change"), /refused/);
  assert.equal(flocks.asked, first);
  assert.equal(flocks.shown, first);
});

test("the score leaves out what was simulated before anybody looked", async () => {
  for (const [ahead, isNumber] of [[0, true], [30, false]]) {
    const flocks = flocksOf(async () => ({ continues: false, values: [answer()], taken: [taken] }));
    await flocks.become({ flock: {}, beside: null }, "open", ahead);
    assert.equal(Number.isFinite(flocks.runs[0].mean("psi_o")), isNumber);
  }
});

test("leaders have one target or several", () => {
  const flocks = flocksOf();
  const { parameters, lengths } = answer(["cw", "ccw"]);
  const opposed = flocks.described({ parameters: { ...parameters, n_leaders: 2 }, lengths }, {});
  assert.deepEqual([opposed.target, opposed.targets], [null, ["cw", "ccw"]]);
  const common = flocks.described(answer("ccw"), {});
  assert.deepEqual([common.target, common.targets], ["ccw", undefined]);
});
