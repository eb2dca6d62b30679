// Law: a recording that is saved holds the samples since the last change.

import assert from "node:assert/strict";
import { test } from "node:test";
import { GrowingRun } from "../../web/growing_run.mjs";
import { readNpz } from "../../web/npz.mjs";
import { derivedOf, recordingOf, showTexts } from "../../web/share.mjs";

const samples = (times) => ({
  time_s: Float64Array.from(times), phase: new Float64Array(times.length), in_analysis_window: new Float64Array(times.length),
  pose: new Float64Array(6 * times.length), velocity: new Float64Array(6 * times.length), rudder: Float64Array.from(times),
  series: Float64Array.from(times, (time) => time / 10), statistics: Float64Array.of(times.length, times.length / 1e5),
  contacts: new Float64Array(0),
});
const statistics = [{ name: "unsolved", kind: "count" }, { name: "worst_overlap_cm", kind: "real" }];

test("samples before the change are left out", async () => {
  const run = new GrowingRun({ boats: 2, leaders: 1, phases: ["fw", "nop1"], seed: "7", stored: { n_boats: 2 } }, ["psi_o"], 10);
  run.append(samples([0, 1, 2]));
  run.describe({ leaders: 1 });
  run.append(samples([3, 4]));
  const about = { format: "a format", version: "1", policy: "learned", recorded: ["psi_o"], statistics };
  const arrays = await readNpz(recordingOf(run, about).buffer);
  assert.deepEqual([...arrays.time_s.values], [2, 3, 4]);
  assert.deepEqual([...arrays.order_psi_o.values], [0.2, 0.3, 0.4]);
  assert.deepEqual(arrays.rudder.shape, [3, 1]);
  assert.equal(arrays.duration_s.values[0], 4);
  assert.equal(arrays.seed.values[0], "7");
  assert.equal(arrays.parameters.values[0], "n_boats = 2\n");
  assert.deepEqual([arrays.statistics_unsolved.values[0], arrays.statistics_unsolved.descr], ["2", "<u8"]);
  assert.deepEqual([arrays.statistics_worst_overlap_cm.values[0], arrays.statistics_worst_overlap_cm.descr], [2e-5, "<f8"]);
  run.statistics = [NaN, NaN];
  const unknown = await readNpz(recordingOf(run, about).buffer);
  assert.deepEqual(Object.keys(arrays).filter((name) => !Object.hasOwn(unknown, name)), ["statistics_unsolved", "statistics_worst_overlap_cm"]);
});

test("the order of other leaders is left out with the sample of the change", async () => {
  const run = new GrowingRun({ boats: 2, leaders: 2, phases: ["fw"], seed: "7", stored: { n_boats: 2 } }, ["psi_o"], 10);
  const two = (times) => ({ ...samples(times), rudder: new Float64Array(2 * times.length) });
  run.append({ ...two([0, 1]), series: Float64Array.of(NaN, NaN) });
  run.describe({ leaders: 1 });
  run.describe({ leaders: 1 });
  run.append(samples([2, 3]));
  const arrays = await readNpz(recordingOf(run, { format: "", version: "", policy: "", recorded: ["psi_o"], statistics }).buffer);
  assert.deepEqual([[...arrays.time_s.values], [...arrays.order_psi_o.values]], [[2, 3], [0.2, 0.3]]);
});

test("what is asked of a recording has the sign of its target, and states where it holds no order", () => {
  const arrays = { time_s: { values: [0, 1] }, pose: { values: Float64Array.from({ length: 6 }, (_, k) => k) }, velocity: { values: new Float64Array(6) } };
  const asked = ["cw", "ccw", null].map((target) => derivedOf(arrays, { target, boats: 1 }, ["psi_o", "phi_o"]));
  assert.deepEqual(asked.map(({ sign }) => sign), [1, -1, 1]);
  assert.deepEqual(asked[0].states.map(({ pose }) => pose), [[[0, 1, 2]], [[3, 4, 5]]]);
  const ordered = { ...arrays, order_psi_o: { values: [1, 1] }, order_phi_o: { values: [0, 0] } };
  assert.equal(derivedOf(ordered, { target: "cw", boats: 1 }, ["psi_o", "phi_o"]).states, null);
});

test("commands and Python last beyond the latest change, though an earlier time is drawn", () => {
  const elements = {};
  globalThis.document = { getElementById: (id) => { elements[id] ??= {}; return elements[id]; } };
  const first = { flock: { bw_s: "0.3" }, beside: null, copies: 1 };
  const past = { first, changes: [{ time: 541.5, fields: { bw_s: "0.5" } }] };
  showTexts({ past, shown: first, kinds: { bw_s: "real" }, linkFields: () => ({ isComplete: true }) }, 538.9);
  assert.match(elements.command.value, /--minutes 10 --at 541.5:bw_s=0.5$/);
  assert.match(elements.python.value, /duration_s=600/);
});
