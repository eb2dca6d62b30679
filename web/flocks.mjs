// The flocks of the page and those beside them: requests to the simulator, and its answers.

import { opposedTargets } from "./controls.mjs";
import { GrowingRun } from "./growing_run.mjs";
import { Laws, TRAINED, YOU } from "./laws.mjs";
import { differences, LATEST, requestsOf, textOf, withChange } from "./request.mjs";

/** Samples per second. */
export const SAMPLING = 10;
/** The map of order leaves out this time after the start, in s: boats start at random and at rest. */
const SETTLING = 30;
/** Most changes of a schedule in a link. */
const MOST_CHANGES = 200;
/** Stands for no boat in questions to the simulator. */
export const NO_BOAT = 1e6;
/** Fields that may change without emptying the map of order. */
const NOT_ON_MAP = new Set(["bw_s", "seed", "target"]);

/** The request after a change of one control. `base`: the request before; `values`: the present parameters. A visitor who steers gets a leader, and a flock to compare with. */
export function changed(base, values, laws, name, value) {
  const wanted = { ...base, flock: { ...base.flock }, beside: base.beside && { ...base.beside } };
  const leaders = Number(values.n_leaders);
  if (name === "beside") {
    const [field, different] = value.split("=");
    wanted.beside = field ? { [field]: different } : null;
  } else if (name === "preset") {
    const { n_boats, n_leaders, seed, leaders: policy } = { ...values, ...wanted.flock };
    wanted.flock = { preset: value, n_boats, n_leaders, ...(seed && { seed }), ...(policy && { leaders: policy }) };
  } else if (name === "leaders" && value === "each") {
    wanted.flock.leaders = laws.policiesFor(base.flock.leaders ?? "", leaders);
  } else if (name === "target") {
    wanted.flock.target = value === "opposed" ? opposedTargets(leaders) : value;
  } else {
    wanted.flock[name] = value;
  }
  // Targets and policies of single leaders follow the number of leaders.
  if (name === "n_leaders" && (wanted.flock.target ?? values.target).includes(",")) {
    wanted.flock.target = Number(value) > 1 ? opposedTargets(Number(value)) : "cw";
  }
  if (name === "n_leaders" && wanted.flock.leaders?.includes(",")) {
    wanted.flock.leaders = laws.policiesFor(wanted.flock.leaders, Number(value));
  }
  if (wanted.flock.leaders === YOU) {
    if (name === "leaders" && leaders === 0) {
      wanted.flock.n_leaders = "1";
    }
    wanted.beside ??= { leaders: laws.atEverySubstep };
  }
  if (name === "leaders" && value !== YOU && base.flock.leaders === YOU) {
    wanted.beside = null;
  }
  return wanted;
}

/** Shortens the names of two kinds of flocks to the part in which they differ; `copies`: number of flocks of each kind. */
function distinguished(descriptions, copies) {
  const parts = descriptions.map(({ name }) => name.split(", "));
  const hasTwoKinds = parts.length > copies;
  const index = hasTwoKinds && parts[0][0] === parts[copies][0] ? 1 : 0;
  return hasTwoKinds ? descriptions.map((flock, k) => ({ ...flock, name: parts[k][index] ?? flock.name })) : descriptions;
}

export class Flocks {
  runs = [];
  /** The latest request, and the request of the runs that are shown. */
  requested = null;
  shown = null;
  /** The request with which the flocks started, the time in s from which their means count, and the changes since the start. */
  past = { first: null, start: 0, changes: [] };
  /** The first flock's parameters as text, as links have them. */
  values = {};
  /** Identifies the flocks that the map of order shows together. */
  signature = "";
  isRecorded = false;
  /** The runs and values that wait while a recording is shown; null without a recording. */
  #waiting = null;
  /** The text of the file of the policy that the visitor trained; null before a training. */
  trained = null;

  /** `kinds`: kinds of the parameters; `laws`: the simulator's table; `series`: names of the quantities; `statistics`: names and kinds of the statistics of substeps; `version`: version of the package. */
  constructor(simulator, { kinds, laws, series, statistics, phases, version }) {
    Object.assign(this, { simulator, kinds, laws: new Laws(laws), series, statistics, phases, version });
  }

  /** Whether the visitor steers the leaders. */
  get areYours() {
    return !this.isRecorded && this.shown?.flock.leaders === YOU;
  }

  /** Whether the leaders follow the policy that the visitor trains. */
  get areTrained() {
    return !this.isRecorded && this.shown?.flock.leaders === TRAINED;
  }

  /** The runs that are drawn: in the game, only those of the visitor. */
  get drawnRuns() {
    return this.areYours ? this.runs.slice(0, this.shown.copies) : this.runs;
  }

  /** Index of the first flock of the second kind, beside the others. */
  get firstBeside() {
    return this.isRecorded ? 1 : this.shown.copies;
  }

  /** The fields of a link to the flocks at a time in s. If there are too many changes, it has only the present request; `isComplete` says so. */
  linkFields(time = 0) {
    const { first, start, changes } = this.past;
    const isComplete = changes.length <= MOST_CHANGES && changes.every((change) => change.time <= LATEST);
    const flocks = isComplete ? { ...first, changes } : this.shown;
    const latest = isComplete ? changes.at(-1)?.time ?? 0 : 0;
    const other = {
      ...(start > latest && start <= LATEST && { start: String(start) }),
      ...(time > Math.max(start, latest) && time <= LATEST && { now: String(time) }),
      ...(first.copies > 1 && { flocks: String(first.copies) }),
    };
    return { ...flocks, other, isComplete };
  }

  /** The policy of the leaders, by name. */
  get policy() {
    return this.shown.flock.leaders ?? this.laws.atEverySubstep;
  }

  /** Lets the simulator open or change the flocks; returns whether they continue from their state. */
  async update(wanted, kind) {
    // Changes that are made before the answer are applied to this request.
    this.requested = wanted;
    const requests = requestsOf(wanted, this.kinds).map((request) =>
      (request.leaders === TRAINED && this.trained ? { ...request, trained: this.trained } : request));
    const { continues, values, taken } = await this.simulator.ask(kind, { requests }).catch((error) => {
      this.requested = this.shown;
      throw error;
    });
    const descriptions = distinguished(values.map((answer, index) => this.#flockDescription(answer, wanted, index, requests[index].seed)), wanted.copies);
    const isSame = continues && descriptions.every(({ boats }, index) => this.runs[index]?.boats === boats);
    const before = this.shown;
    this.shown = wanted;
    this.values = descriptions[0].parameters;
    this.signature = JSON.stringify(Object.entries(this.values).filter(([name]) => !NOT_ON_MAP.has(name)));
    this.isRecorded = false;
    this.#waiting = null;
    if (isSame) {
      this.runs.forEach((run, index) => { run.describe(descriptions[index]); });
    } else {
      this.runs = descriptions.map((flock) => new GrowingRun(flock, this.series));
    }
    this.append(taken);
    const end = Number(this.runs[0].end.toFixed(1));
    this.past = isSame ? { ...this.past, start: end, changes: withChange(this.past.changes, end, differences(before.flock, wanted.flock)) } :
      { first: wanted, start: 0, changes: [] };
    return isSame;
  }

  /** Lets the simulator advance the flocks, by at most half of what their runs keep, and appends its samples; returns its answer. */
  async advance(question, onCycle) {
    const { runs } = this;
    const answer = await this.simulator.ask("advance", { ...question, samples: Math.min(question.samples, ...runs.map(({ capacity }) => capacity >> 1)) });
    // In the meantime, other flocks may have replaced these, or a recording may be shown.
    if (runs === this.runs || runs === this.#waiting?.runs) {
      this.append(answer.taken, onCycle, runs);
    }
    return answer;
  }

  /** Appends samples to the runs. `onCycle` gets the first flock's noise and the mean order of each analysis window. */
  append(taken, onCycle = () => {}, runs = this.runs) {
    taken.forEach((samples, index) => {
      runs[index].append(samples, index === 0 && runs[0].end > SETTLING ? (order) => onCycle(runs[0].bw_s, order) : undefined);
    });
  }

  /** Advances the flocks to a time in s; stops if `isWanted` says no, or other flocks replace them. */
  async runTo(time, isWanted) {
    const { runs } = this;
    for (;;) {
      const samples = Math.round(SAMPLING * (time - runs[0].end));
      if (samples <= 0 || runs !== this.runs || !isWanted()) {
        return;
      }
      await this.advance({ samples, milliseconds: 200, boat: NO_BOAT, heading: 0 });
    }
  }

  /** Lets the leaders that the visitor trains follow a newer policy from now on. */
  async teach(policy) {
    this.trained = policy;
    await this.simulator.ask("teach", { policy });
  }

  /** Restarts the flocks' means. */
  restartMeans() {
    this.past.start = Number(this.runs[0].end.toFixed(1));
    this.runs.forEach((run) => { run.restartMeans(); });
  }

  /** Shows a recording's run instead of the flocks, which wait. */
  show(run) {
    if (!this.isRecorded) {
      const { runs, values } = this;
      this.#waiting = { runs, values };
    }
    Object.assign(this, { runs: [run], values: run.parameters, isRecorded: true });
  }

  /** Shows the waiting flocks again instead of the recording. */
  returnToFlocks() {
    Object.assign(this, this.#waiting, { isRecorded: false });
    this.#waiting = null;
  }

  #flockDescription(answer, wanted, index, seed = "0") {
    const fields = index < wanted.copies ? wanted.flock : { ...wanted.flock, ...wanted.beside };
    const leaders = answer.parameters.n_leaders;
    const policy = fields.leaders ?? this.laws.atEverySubstep;
    const steering = policy.includes(",") ? "each its own" : this.laws.words(policy);
    const name = leaders === 0 ? "no leaders" : `${leaders} leader${leaders > 1 ? "s" : ""}, ${steering}`;
    return this.runDescription(answer, { name, seed, law: policy, version: this.version });
  }

  /** The description of a flock as runs and panels have it, from the simulator's answer. `otherFields`: further fields of the description. */
  runDescription({ parameters, lengths }, otherFields) {
    const { n_leaders: leaders, target } = parameters;
    const targets = [target].flat();
    const isCommon = leaders > 0 && new Set(targets).size === 1;
    return {
      ...otherFields, lengths, leaders, boats: parameters.n_boats, bw_s: parameters.bw_s, stored: parameters,
      parameters: Object.fromEntries(Object.keys(this.kinds).map((field) => [field, textOf(parameters[field])])),
      target: isCommon ? targets[0] : null, targets: leaders > 0 && !isCommon ? targets : undefined,
      ...Object.fromEntries(Object.entries(parameters).filter(([field]) => this.kinds[field] === "rows")), phases: this.phases, ids: null, every: 1,
    };
  }

  /** The value that each control shows. */
  get controlValues() {
    const { flock, beside } = this.shown;
    const target = this.values.target.includes(",") ? "opposed" : this.values.target;
    const besideFields = Object.entries(beside ?? {}).map(([name, value]) => `${name}=${value}`).join(" ");
    return { ...this.values, target, preset: flock.preset ?? "simulation", leaders: this.policy, beside: besideFields };
  }
}
