// Recordings of flocks as files, recordings that are dropped onto the page, and flocks as commands and in Python.

import { GrowingRun } from "./growing_run.mjs";
import { TRAINED, YOU } from "./laws.mjs";
import { array, readNpz, writeNpz } from "./npz.mjs";
import { checkRecording } from "./recording.mjs";
import { tomlOf, valuesOfToml } from "./request.mjs";
import { commandLine, isSchedule, pythonText } from "./texts.mjs";

/** Least duration in s of a run in commands and in Python. */
const LEAST_SECONDS = 480;

/**
 * The bytes of a recording of a run since its last change, as flockenv.Recording.load reads them. `format` and `version`: of recordings
 * and of the package; `policy`: the leaders' policy; `recorded`: names of the quantities that recordings hold; `statistics`: names and kinds of
 * the statistics of substeps.
 */
export function recordingOf(run, { format, version, policy, recorded, statistics }) {
  const { firstSinceChange: first, raw, length } = run;
  const [samples, boats, leaders] = [length - first, run.boats, run.leaders];
  const phases = Array.from(raw.phase.from(first), (index) => run.phases[index]);
  const series = Object.fromEntries(recorded.map((name) => {
    const values = Float64Array.from({ length: samples }, (_, k) => run.value(name, first + k));
    return [`order_${name}`, array.reals(values, [samples])];
  }));
  // A recording from a file may have no statistics.
  const knownStatistics = statistics.every((_, index) => Number.isFinite(run.statistics[index])) ? statistics : [];
  const statisticsArrays = Object.fromEntries(knownStatistics.map(({ name, kind }, index) => {
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
    ...statisticsArrays,
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
 * Reads a recording's file as a run. `check` returns the parameters and lengths of a request, `describe` the description of a
 * run, and `derive` the quantities of all samples.
 */
export async function runOfFile(file, about, { check, describe, derive }) {
  const failAs = (words) => (error) => { throw new Error(`${words}: ${error.message}`); };
  const bytes = await file.arrayBuffer();
  const isZip = new TextDecoder("latin1").decode(bytes.slice(0, 4)) === "PK\x03\x04";
  const arrays = await readNpz(bytes).catch(isZip ? failAs("is not a complete, undamaged .npz file") :
    () => { throw new Error("is not an .npz file, in which recordings are saved"); });
  const answer = await checkRecording(arrays, about, async (toml) => check({ parameters: valuesOfToml(toml) }))
    .catch(failAs("is not a recording of flockenv"));
  const description = describe(answer, {
    name: file.name, seed: String(arrays.seed.values[0]), version: arrays.version.values[0],
  });
  const samples = arrays.time_s.values.length;
  if (samples === 0 || arrays.pose.shape[1] === 0) {
    throw new Error("is a recording without samples or poses, and cannot be shown");
  }
  if (arrays.ids) {
    throw new Error("holds tracks, which `flockenv replay` shows");
  }
  const run = new GrowingRun({ ...description, isRecorded: true }, about.series, samples);
  run.append({
    time_s: arrays.time_s.values,
    phase: arrays.phase.values.map((name) => about.phases.indexOf(name)),
    in_analysis_window: arrays.in_analysis_window.values,
    pose: arrays.pose.values,
    velocity: arrays.velocity.values,
    rudder: Float64Array.from(arrays.rudder?.values ?? new Float64Array(samples * description.leaders)),
    series: await derive(arrays, description),
    statistics: about.statistics.map(({ name }) => Number(arrays[`statistics_${name}`]?.values[0] ?? NaN)),
    contacts: new Float64Array(0),
  });
  return run;
}

/** The question to the simulator for all quantities of a recording. It has the states only if order was not recorded. */
export function derivedOf(arrays, { target, boats }, names) {
  const recorded = Object.fromEntries(names.filter((name) => arrays[`order_${name}`]).map((name) => [name, arrays[`order_${name}`].values]));
  const samples = arrays.time_s.values.length;
  const rows = (values, k) => Array.from({ length: boats }, (_, boat) => Array.from(values.subarray(3 * (k * boats + boat), 3 * (k * boats + boat + 1))));
  const hasOrder = ["psi_o", "phi_o"].every((name) => recorded[name]);
  const states = hasOrder ? null : Array.from({ length: samples }, (_, k) =>
    ({ pose: rows(arrays.pose.values, k), velocity: rows(arrays.velocity.values, k) }));
  return { names, recorded, states, samples, sign: target === "ccw" ? -1 : 1 };
}

/** Shows commands and Python that simulate the flocks up to a time in s. */
export function showTexts(flocks, time) {
  const { first, changes } = flocks.past;
  const hasSchedule = isSchedule(changes);
  const schedule = hasSchedule ? changes : [];
  const { flock, beside } = hasSchedule ? first : flocks.shown;
  const isYours = flock.leaders === YOU;
  const { leaders: _, ...withoutPolicy } = flock;
  const shownFlocks = [isYours ? withoutPolicy : flock];
  if (beside && !isYours) {
    shownFlocks.push({ ...flock, ...beside });
  }
  const isTrained = shownFlocks.some(({ leaders }) => leaders === TRAINED);
  const trainedPolicy = flocks.trained ? "policy.json" : "straight ahead";
  const runnable = shownFlocks.map((fields) => (fields.leaders === TRAINED ? { ...fields, leaders: trainedPolicy } : fields));
  // The latest change may be later than the time that is drawn.
  const latest = Math.max(time, schedule.at(-1)?.time ?? 0);
  const seconds = Math.max(LEAST_SECONDS, 60 * Math.ceil((latest + 1) / 60));
  const commands = runnable.map((fields) => commandLine(fields, seconds, schedule));
  const byId = (id) => document.getElementById(id);
  byId("command").value = commands.join("\n").trim();
  byId("python").value = pythonText(runnable, seconds, flocks.kinds, schedule);
  byId("same").textContent = [
    isYours ? "How you steered is in the recording alone: these run the law in your place. " : "",
    isTrained && flocks.trained ? "policy.json is the file of your training, which led with earlier policies on the way. " : "",
    commands.includes("") ? "No command gives each leader a policy of its own, as Python does. " : "",
    hasSchedule ? "" : "These start as the flock is now: the link alone knows how leaders or the preset changed on the way. ",
    flocks.linkFields().isComplete ? "" : "So much changed on the way that the link holds the parameters of now alone. ",
  ].join("");
}
