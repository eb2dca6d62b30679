// A flock's recording as a file, a recording that is dropped onto the page, and the texts of a flock.

import { GrowingRun } from "./growing_run.mjs";
import { TRAINED, YOU } from "./laws.mjs";
import { array, readNpz, writeNpz } from "./npz.mjs";
import { checkedArrays } from "./recording.mjs";
import { tomlOf, valuesOfToml } from "./request.mjs";
import { commandLine, isSchedule, pythonText } from "./texts.mjs";

/** Shortest duration in s of the commands that show the same flock. */
const SECONDS = 480;

/**
 * The bytes of a recording of a run since it last changed, as flockenv.Recording.load reads them. `about`: the
 * format and the version of the package; `policy`: how leaders steered; `recorded`: the names of the quantities that
 * recordings hold; `statistics`: names and kinds of the statistics of substeps.
 */
export function recordingOf(run, { format, version, policy, recorded, statistics }) {
  const first = run.sampleAt(run.changedAt);
  const { raw, length } = run;
  const [samples, boats, leaders] = [length - first, run.boats, run.leaders];
  const phases = Array.from(raw.phase.from(first), (index) => run.phases[index]);
  const series = Object.fromEntries(recorded.map((name) => {
    const values = Float64Array.from({ length: samples }, (_, k) => run.value(name, first + k));
    return [`order_${name}`, array.reals(values, [samples])];
  }));
  // A recording from a file may not have them.
  const known = statistics.every((_, index) => Number.isFinite(run.statistics[index])) ? statistics : [];
  const counted = Object.fromEntries(known.map(({ name, kind }, index) => {
    const value = run.statistics[index];
    return [`statistics_${name}`, kind === "count" ? array.whole(value) : array.reals([value], [])];
  }));
  return writeNpz({
    time_s: array.reals(raw.time_s.from(first), [samples]),
    phase: array.texts(phases, [samples], Math.max(...run.phases.map((name) => name.length))),
    in_analysis_window: array.flags(raw.in_analysis_window.from(first), [samples]),
    pose: array.reals(raw.pose.from(first), [samples, boats, 3]),
    velocity: array.reals(raw.velocity.from(first), [samples, boats, 3]),
    ...series,
    rudder: array.reals(raw.rudder.from(first, leaders), [samples, leaders]),
    ...counted,
    format: array.texts([format], []),
    version: array.texts([version], []),
    parameters: array.texts([tomlOf(run.stored)], []),
    policy: array.texts([policy], []),
    seed: array.whole(run.seed),
    duration_s: array.reals([run.end], []),
  });
}

/** Saves bytes as a file through the browser. */
export function download(bytes, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([bytes]));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

/**
 * The run of a recording's file. `check` gives the parameters and lengths of a request, `describe` the description of a
 * run, and `derive` the rows of the quantities.
 */
export async function runOfFile(file, about, { check, describe, derive }) {
  const because = (words) => (error) => { throw new Error(`${words}: ${error.message}`); };
  const bytes = await file.arrayBuffer();
  const isZip = new TextDecoder("latin1").decode(bytes.slice(0, 4)) === "PK\x03\x04";
  const arrays = await readNpz(bytes).catch(isZip ? because("is not a complete, undamaged .npz file") :
    () => { throw new Error("is not an .npz file, in which recordings are saved"); });
  const checked = await checkedArrays(arrays, about, async (toml) => check({ parameters: valuesOfToml(toml) }))
    .catch(because("is not a recording of flockenv"));
  const described = describe(checked, {
    name: file.name, seed: String(arrays.seed.values[0]), version: arrays.version.values[0],
  });
  const samples = arrays.time_s.values.length;
  if (samples === 0 || arrays.pose.shape[1] === 0) {
    throw new Error("is a recording without samples or poses, and cannot be shown");
  }
  if (arrays.ids) {
    throw new Error("holds tracks, which `flockenv replay` shows");
  }
  const run = new GrowingRun({ ...described, isRecorded: true }, about.series, samples);
  run.append({
    time_s: arrays.time_s.values,
    phase: arrays.phase.values.map((name) => about.phases.indexOf(name)),
    in_analysis_window: arrays.in_analysis_window.values,
    pose: arrays.pose.values,
    velocity: arrays.velocity.values,
    rudder: Float64Array.from(arrays.rudder?.values ?? new Float64Array(samples * described.leaders)),
    series: await derive(arrays, described),
    statistics: about.statistics.map(({ name }) => Number(arrays[`statistics_${name}`]?.values[0] ?? NaN)),
    contacts: new Float64Array(0),
  });
  return run;
}

/** The quantities of a recording, from what it holds: the question that the simulator answers. */
export function derivedOf(arrays, { target, boats }, names) {
  const recorded = Object.fromEntries(names.filter((name) => arrays[`order_${name}`]).map((name) => [name, arrays[`order_${name}`].values]));
  const samples = arrays.time_s.values.length;
  const rows = (values, k) => Array.from({ length: boats }, (_, boat) => Array.from(values.subarray(3 * (k * boats + boat), 3 * (k * boats + boat + 1))));
  const isWhole = ["psi_o", "phi_o"].every((name) => recorded[name]);
  const states = isWhole ? null : Array.from({ length: samples }, (_, k) =>
    ({ pose: rows(arrays.pose.values, k), velocity: rows(arrays.velocity.values, k) }));
  return { names, recorded, states, samples, sign: target === "ccw" ? -1 : 1 };
}

/** Writes the flocks at a time as commands and in Python. */
export function showTexts(flocks, time) {
  const { first, changes } = flocks.past;
  const hasSchedule = isSchedule(changes);
  const schedule = hasSchedule ? changes : [];
  const { flock, beside } = hasSchedule ? first : flocks.shown;
  const isYours = flock.leaders === YOU;
  const { leaders: _, ...lawful } = flock;
  const given = [isYours ? lawful : flock];
  if (beside && !isYours) {
    given.push({ ...flock, ...beside });
  }
  const isTrained = given.some(({ leaders }) => leaders === TRAINED);
  const texts = given.map((fields) => (fields.leaders === TRAINED ? { ...fields, leaders: flocks.trained ? "policy.json" : "straight ahead" } : fields));
  const seconds = Math.max(SECONDS, 60 * Math.ceil((time + 1) / 60));
  const commands = texts.map((fields) => commandLine(fields, seconds, schedule));
  const byId = (id) => document.getElementById(id);
  byId("command").value = commands.join("\n").trim();
  byId("python").value = pythonText(texts, seconds, flocks.kinds, schedule);
  byId("same").textContent = [
    isYours ? "How you steered is in the recording alone: these run the law in your place. " : "",
    isTrained && flocks.trained ? "policy.json is the file of your training, which led with earlier policies on the way. " : "",
    commands.includes("") ? "No command gives each leader a policy of its own, as Python does. " : "",
    hasSchedule ? "" : "These start as the flock is now: the link alone knows how leaders or the preset changed on the way. ",
    flocks.linked().isWhole ? "" : "So much changed on the way that the link holds the parameters of now alone. ",
  ].join("");
}
