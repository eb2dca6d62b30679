// Law: what is not a recording is refused by a sentence, and what rounding leaves of one is not.

import assert from "node:assert/strict";
import { test } from "node:test";
import { array, readNpz, writeNpz } from "../../web/npz.mjs";
import { checkRecording } from "../../web/recording.mjs";

const QUANTITIES = [{ key: "psi_o", kind: "recorded", least_boats: 1 }, { key: "c_o", kind: "recorded", least_boats: 2 }];
const STATISTICS = [{ name: "unsolved", kind: "count" }, { name: "worst_overlap_cm", kind: "real" }];
const ABOUT = { format: "a format", phases: ["fw", "bw"], quantities: QUANTITIES, statistics: STATISTICS };
const CONTACTS = { count: [0, 1], i: [0], j: [1], normal: [1, 0], force: [2], point_cm: [0, 0], along_cm: [0] };
const INTEGERS = { count: ["<i8", BigInt64Array], i: ["<i4", Int32Array], j: ["<i4", Int32Array] };

/** The arrays of a recording of two samples and three boats, of which one leads, with other arrays in their place. */
async function arraysOf({ contacts, ...others } = {}) {
  const reals = (count, shape) => array.reals(new Float64Array(count), shape);
  const arrays = {
    time_s: array.reals([0, 1], [2]), phase: array.texts(["fw", "bw"], [2]), in_analysis_window: array.flags([0, 1], [2]),
    pose: reals(18, [2, 3, 3]), velocity: reals(18, [2, 3, 3]), seed: array.whole(7), duration_s: array.reals([1], []),
    ...Object.fromEntries(["version", "parameters", "policy"].map((name) => [name, array.texts(["x"], [])])),
    format: array.texts(["a format"], []), ...others,
  };
  const read = await readNpz(writeNpz(arrays).buffer);
  const [c] = [contacts?.i.length];
  for (const [name, values] of Object.entries(contacts ?? {})) {
    const [descr, kind] = INTEGERS[name] ?? ["<f4", Float32Array];
    const shape = { count: [2], normal: [c, 2], point_cm: [c, 2] }[name] ?? [c];
    read[`contacts_${name}`] = { descr, shape, values: descr === "<i8" ? Float64Array.from(values) : kind.from(values) };
  }
  return read;
}

const check = async (others, parameters = {}) =>
  checkRecording(await arraysOf(others), ABOUT, async () => ({ parameters: { n_boats: 3, n_leaders: 1, discs: [], walls: [], ...parameters } }));

test("a recording is accepted, and its last time may lie beyond its end by a rounding", async () => {
  await check();
  await check({ time_s: array.reals([0, 1 + 5e-10], [2]) });
  await assert.rejects(check({ time_s: array.reals([0, 1 + 2e-9], [2]) }), /time_s must increase/);
});

test("quantities are undefined where there are too few normal boats, and only there", async () => {
  const order_c_o = array.reals([NaN, NaN], [2]);
  await check({ order_c_o }, { n_leaders: 2 });
  await assert.rejects(check({ order_c_o }), /order.c_o must be finite/);
  await assert.rejects(check({ order_c_o: array.reals([0, 0], [2]) }, { n_leaders: 2 }), /order.c_o must be undefined/);
});

test("statistics are single numbers, all of them or none", async () => {
  const [statistics_unsolved, statistics_worst_overlap_cm] = [array.whole(2), array.reals([1e-5], [])];
  await check({ statistics_unsolved, statistics_worst_overlap_cm });
  await check({ statistics_unsolved: array.texts(["2"], []) });
  for (const other of [array.texts(["2"], []), array.reals([1, 2], [2]), array.flags([1], [])]) {
    await assert.rejects(check({ statistics_unsolved: other, statistics_worst_overlap_cm }), /statistics_unsolved must be one number/);
  }
});

test("contacts are among boats, the pool's walls, discs and walls, in their order below zero", async () => {
  const more = { discs: [[0, 0, 1]], walls: [[0, 0, 1, 0, 1]] };
  for (const [j, parameters, isAccepted] of [[2, {}, true], [3, {}, false], [-2, {}, true], [-3, {}, false], [-4, more, true], [-5, more, false]]) {
    const checked = check({ contacts: { ...CONTACTS, j: [j] } }, parameters);
    await (isAccepted ? checked : assert.rejects(checked, /must be among 3 boats/));
  }
});
