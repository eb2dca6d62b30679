// The shown flocks and those beside them: requests to the simulator, and its answers.

import { opposedTargets } from "./controls.mjs";
import { GrowingRun } from "./growing_run.mjs";
import { Laws, TRAINED, YOU } from "./laws.mjs";
import { differences, LATEST, requestsOf, textOf, withChange } from "./request.mjs";

/** Samples per second. */
export const SAMPLING = 10;
/** Seconds after the start that a map leaves out: boats start at random and at rest. */
const SETTLING = 30;
/** Most changes of a schedule in a link. */
const MOST_CHANGES = 200;
/** Number that stands for no boat. */
export const NO_BOAT = 1e6;
/** Fields whose change makes a flock another one on the map of order. */
const NOT_ON_MAP = new Set(["bw_s", "seed", "target"]);

/** The requested flocks after a change of one field. `values`: the present parameters; `laws`: the known laws. */
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
    wanted.flock.leaders = laws.forEach(base.flock.leaders ?? "", leaders);
  } else if (name === "target") {
    wanted.flock.target = value === "opposed" ? opposedTargets(leaders) : value;
  } else {
    wanted.flock[name] = value;
  }
  if (name === "n_leaders" && (wanted.flock.target ?? values.target).includes(",")) {
    wanted.flock.target = Number(value) > 1 ? opposedTargets(Number(value)) : "cw";
  }
  if (name === "n_leaders" && wanted.flock.leaders?.includes(",")) {
    wanted.flock.leaders = laws.forEach(wanted.flock.leaders, Number(value));
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

/** Names flocks that stand beside each other by what distinguishes them. */
function distinguished(described, copies) {
  const parts = described.map(({ name }) => name.split(", "));
  const isPair = parts.length > copies;
  const index = isPair && parts[0][0] === parts[copies][0] ? 1 : 0;
  return described.map((flock, k) => ({ ...flock, name: isPair ? parts[k][index] ?? flock.name : flock.name }));
}

export class Flocks {
  runs = [];
  /** The latest request, and the request that the shown runs belong to. */
  asked = null;
  shown = null;
  /** The flocks' start, the time from which their means count, and their changes since. */
  past = { first: null, start: 0, changes: [] };
  /** The first flock's parameters, as links have them. */
  values = {};
  /** The flocks that a map of order shows together. */
  signature = "";
  isRecorded = false;
  /** The flocks that wait behind a recording; null for none. */
  #behind = null;
  /** The policy that the visitor trained, as a file's text; null for none. */
  trained = null;

  /** `kinds`: those of the parameters; `laws`: the simulator's table; `series`: the names of the quantities; `statistics`: what is counted of substeps; `version`: that of the package. */
  constructor(simulator, { kinds, laws, series, statistics, phases, version }) {
    Object.assign(this, { simulator, kinds, laws: new Laws(laws), series, statistics, phases, version });
  }

  get areYours() {
    return !this.isRecorded && this.shown?.flock.leaders === YOU;
  }

  get areTrained() {
    return !this.isRecorded && this.shown?.flock.leaders === TRAINED;
  }

  /** The runs with a picture: all but the flocks that the law leads beside those of a visitor. */
  get seen() {
    return this.areYours ? this.runs.slice(0, this.shown.copies) : this.runs;
  }

  /** Index of the first flock of the second kind. */
  get besides() {
    return this.isRecorded ? 1 : this.shown.copies;
  }

  /** The part of a link for the flocks at a time; changes beyond its limit are left out. */
  linked(time = 0) {
    const { first, start, changes } = this.past;
    const isWhole = changes.length <= MOST_CHANGES && changes.every((change) => change.time <= LATEST);
    const flocks = isWhole ? { ...first, changes } : this.shown;
    const latest = isWhole ? changes.at(-1)?.time ?? 0 : 0;
    const other = {
      ...(start > latest && { start: String(start) }),
      ...(time > Math.max(start, latest) && time <= LATEST && { now: String(time) }),
      ...(first.copies > 1 && { flocks: String(first.copies) }),
    };
    return { ...flocks, other, isWhole };
  }

  get policy() {
    return this.shown.flock.leaders ?? this.laws.atEverySubstep;
  }

  /** Lets the simulator open or change the flocks; returns whether they continue from their state. */
  async become(wanted, kind) {
    // Changes that are made before the answer are applied to this request.
    this.asked = wanted;
    const requests = requestsOf(wanted, this.kinds).map((request) =>
      (request.leaders === TRAINED && this.trained ? { ...request, trained: this.trained } : request));
    const { continues, values, taken } = await this.simulator.ask(kind, { requests }).catch((error) => {
      this.asked = this.shown;
      throw error;
    });
    const described = distinguished(values.map((answer, index) => this.#describe(answer, wanted, index, requests[index].seed)), wanted.copies);
    const isSame = continues && described.every(({ boats }, index) => this.runs[index]?.boats === boats);
    const before = this.shown;
    this.shown = wanted;
    this.values = described[0].parameters;
    this.signature = JSON.stringify(Object.entries(this.values).filter(([name]) => !NOT_ON_MAP.has(name)));
    this.isRecorded = false;
    this.#behind = null;
    if (isSame) {
      this.runs.forEach((run, index) => { run.describe(described[index]); });
    } else {
      this.runs = described.map((flock) => new GrowingRun(flock, this.series));
    }
    this.append(taken);
    const end = Number(this.runs[0].end.toFixed(1));
    this.past = isSame ? { ...this.past, start: end, changes: withChange(this.past.changes, end, differences(before.flock, wanted.flock)) } :
      { first: wanted, start: 0, changes: [] };
    return isSame;
  }

  /** Advances the flocks by a number of samples at most, within some time; returns the simulator's answer. */
  async advance(question, onCycle) {
    const { runs } = this;
    const said = await this.simulator.ask("advance", question);
    // In the meantime, other flocks may have replaced these, or a recording may be shown.
    if (runs === this.runs || runs === this.#behind?.runs) {
      this.append(said.taken, onCycle, runs);
    }
    return said;
  }

  append(taken, onCycle = () => {}, runs = this.runs) {
    taken.forEach((samples, index) => {
      runs[index].append(samples, index === 0 && runs[0].end > SETTLING ? (order) => onCycle(runs[0].bw_s, order) : undefined);
    });
  }

  /** Advances the flocks to a time in s, unless this is canceled or other flocks replace them. */
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
      this.#behind = { runs, values };
    }
    Object.assign(this, { runs: [run], values: run.parameters, isRecorded: true });
  }

  /** Shows the waiting flocks again instead of the recording. */
  comeBack() {
    Object.assign(this, this.#behind, { isRecorded: false });
    this.#behind = null;
  }

  #describe(answer, wanted, index, seed = "0") {
    const fields = index < wanted.copies ? wanted.flock : { ...wanted.flock, ...wanted.beside };
    const leaders = answer.parameters.n_leaders;
    const policy = fields.leaders ?? this.laws.atEverySubstep;
    const steering = policy.includes(",") ? "each its own" : this.laws.words(policy);
    const name = leaders === 0 ? "no leaders" : `${leaders} leader${leaders > 1 ? "s" : ""}, ${steering}`;
    return this.described(answer, { name, seed, law: policy, version: this.version });
  }

  /** A flock for runs and panels, from the simulator's answer. */
  described({ parameters, lengths }, named) {
    const { n_leaders: leaders, target } = parameters;
    const targets = [target].flat();
    const isCommon = leaders > 0 && new Set(targets).size === 1;
    return {
      ...named, lengths, leaders, boats: parameters.n_boats, bw_s: parameters.bw_s, stored: parameters,
      parameters: Object.fromEntries(Object.keys(this.kinds).map((field) => [field, textOf(parameters[field])])),
      target: isCommon ? targets[0] : null, targets: leaders > 0 && !isCommon ? targets : undefined,
      ...Object.fromEntries(Object.entries(parameters).filter(([field]) => this.kinds[field] === "rows")), phases: this.phases, ids: null, every: 1,
    };
  }

  /** Values of the controls. */
  get controlled() {
    const { flock, beside } = this.shown;
    const target = this.values.target.includes(",") ? "opposed" : this.values.target;
    const differs = Object.entries(beside ?? {}).map(([name, value]) => `${name}=${value}`).join(" ");
    return { ...this.values, target, preset: flock.preset ?? "simulation", leaders: this.policy, beside: differs };
  }
}
