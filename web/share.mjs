// A flock taken along: the file of its recording, and a file that is dropped onto the page.

import { GrowingRun } from "./growing_run.mjs";
import { array, readNpz, writeNpz } from "./npz.mjs";
import { requestOfToml, tomlOf } from "./request.mjs";

/** What every recording holds of a sample besides its quantities. */
const SAMPLED = ["time_s", "phase", "in_analysis_window", "pose", "velocity"];

/**
 * The bytes of a recording of a run since it last changed, as flockenv.Recording.load reads them. `about`: the
 * format and the version of the package; `policy`: how leaders steered; `kinds`: those of the parameters;
 * `recorded`: the names of the quantities that recordings hold.
 */
export function recordingOf(run, { format, version, policy, kinds, recorded }) {
  const first = run.sampleAt(run.changedAt);
  const { raw, length } = run;
  const [samples, boats, leaders] = [length - first, run.boats, run.leaders];
  const phases = Array.from(raw.phase.from(first), (place) => run.phases[place]);
  const series = Object.fromEntries(recorded.map((name) => {
    const values = Float64Array.from({ length: samples }, (_, k) => run.value(name, first + k));
    return [`order_${name}`, array.reals(values, [samples])];
  }));
  return writeNpz({
    time_s: array.reals(raw.time_s.from(first), [samples]),
    phase: array.texts(phases, [samples], Math.max(...run.phases.map((name) => name.length))),
    in_analysis_window: array.flags(raw.in_analysis_window.from(first), [samples]),
    pose: array.reals(raw.pose.from(first), [samples, boats, 3]),
    velocity: array.reals(raw.velocity.from(first), [samples, boats, 3]),
    ...series,
    rudder: array.reals(raw.rudder.from(first, leaders), [samples, leaders]),
    format: array.texts([format], []),
    version: array.texts([version], []),
    parameters: array.texts([tomlOf(run.parameters, kinds)], []),
    policy: array.texts([policy], []),
    seed: array.whole(run.seed),
    duration_s: array.reals([run.end], []),
  });
}

/** Has the browser keep bytes as a file. */
export function download(bytes, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([bytes]));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

/**
 * The run of a recording's file. `describe` turns a request and a name into what a run is described by, and `derive`
 * gives the rows of the quantities `series` from the recorded ones.
 */
export async function runOfFile(file, { describe, derive, series, phases }) {
  const arrays = await readNpz(await file.arrayBuffer());
  if (!String(arrays.format?.values[0] ?? "").startsWith("flockenv recording")) {
    throw new Error("it is no recording of flockenv");
  }
  const missing = SAMPLED.find((name) => !Object.hasOwn(arrays, name));
  if (missing || !arrays.parameters) {
    throw new Error(`it holds no ${missing ?? "parameters"}`);
  }
  const described = await describe(requestOfToml(arrays.parameters.values[0]), {
    name: file.name, seed: String(arrays.seed?.values[0] ?? ""), version: String(arrays.version?.values[0] ?? ""),
  });
  const samples = arrays.time_s.values.length;
  const isWhole = (name, width) => arrays[name].values.length === samples * width;
  if (samples === 0 || !["pose", "velocity"].every((name) => isWhole(name, 3 * described.boats)) ||
      !["phase", "in_analysis_window"].every((name) => isWhole(name, 1))) {
    throw new Error("it holds no poses, or parts of it do not belong together");
  }
  const run = new GrowingRun({ ...described, isRecorded: true }, series, samples);
  const rudder = arrays.rudder?.values ?? new Float64Array(samples * described.leaders);
  run.append({
    time_s: arrays.time_s.values,
    phase: arrays.phase.values.map((name) => Math.max(phases.indexOf(name), 0)),
    in_analysis_window: arrays.in_analysis_window.values,
    pose: arrays.pose.values,
    velocity: arrays.velocity.values,
    rudder: rudder.length === samples * described.leaders ? Float64Array.from(rudder) : new Float64Array(samples * described.leaders),
    series: await derive(arrays, described),
    contacts: new Float64Array(0),
  });
  return run;
}
