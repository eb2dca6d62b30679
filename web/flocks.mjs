// The flocks that are shown, one or two: what is asked of the simulator, and what it answers.

import { opposedTargets } from "./controls.mjs";
import { GrowingRun } from "./growing_run.mjs";
import { Laws, YOU } from "./laws.mjs";
import { requestsOf, textOf } from "./request.mjs";

/** Samples per second. */
const SAMPLING = 10;
/** Fields whose change makes another flock of a map's. */
const NOT_ON_MAP = new Set(["bw_s", "seed", "target"]);

/** What is wanted after a change of one field. `values`: those of the parameters now; `laws`: those that there are. */
export function changed(base, values, laws, name, value) {
  const wanted = { flock: { ...base.flock }, beside: base.beside && { ...base.beside } };
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

/** Two flocks are called by what distinguishes them. */
function distinguished(described) {
  const parts = described.map(({ name }) => name.split(", "));
  const place = parts.length > 1 && parts[0][0] === parts[1][0] ? 1 : 0;
  return parts.length === 1 ? described : described.map((each, k) => ({ ...each, name: parts[k][place] ?? each.name }));
}

export class Flocks {
  runs = [];
  /** What was last asked for, and what the runs are. */
  asked = null;
  shown = null;
  /** The first flock's parameters, as links have them. */
  values = {};
  /** What a map of order shows together. */
  signature = "";
  isRecorded = false;

  /** `kinds`: those of the parameters; `laws`: the simulator's table; `series`: the names of the quantities; `version`: that of the package. */
  constructor(simulator, { kinds, laws, series, phases, version }) {
    Object.assign(this, { simulator, kinds, laws: new Laws(laws), series, phases, version });
  }

  get areYours() {
    return !this.isRecorded && this.shown?.flock.leaders === YOU;
  }

  get policy() {
    return this.shown.flock.leaders ?? this.laws.atEverySubstep;
  }

  /** Has the simulator open or change the flocks; returns whether they continue from where they were. */
  async become(wanted, kind, aheadSeconds = 0) {
    // What is changed meanwhile is changed of this.
    this.asked = wanted;
    const question = { requests: requestsOf(wanted, this.kinds), ahead: SAMPLING * aheadSeconds };
    const { continues, values, taken } = await this.simulator.ask(kind, question).catch((error) => {
      this.asked = this.shown;
      throw error;
    });
    const described = distinguished(values.map((each, place) => this.#describe(each, wanted, place)));
    const isSame = continues && described.every(({ boats }, place) => this.runs[place]?.boats === boats);
    this.shown = wanted;
    this.values = described[0].parameters;
    this.signature = JSON.stringify(Object.entries(this.values).filter(([name]) => !NOT_ON_MAP.has(name)));
    this.isRecorded = false;
    if (isSame) {
      this.runs.forEach((run, place) => { run.describe(described[place]); });
    } else {
      this.runs = described.map((each) => new GrowingRun(each, this.series));
    }
    taken.forEach((each, place) => { this.runs[place].append(each); });
    if (aheadSeconds > 0) {
      this.runs.forEach((run) => { run.countAnew(); });
    }
    return isSame;
  }

  /** Shows a recording's run in place of them. */
  show(run) {
    this.runs = [run];
    this.values = run.parameters;
    this.isRecorded = true;
  }

  #describe(answer, wanted, place) {
    const fields = place === 0 ? wanted.flock : { ...wanted.flock, ...wanted.beside };
    const leaders = answer.parameters.n_leaders;
    const policy = fields.leaders ?? this.laws.atEverySubstep;
    const steering = policy.includes(",") ? "each its own" : this.laws.words(policy);
    const name = leaders === 0 ? "no leaders" : `${leaders} leader${leaders > 1 ? "s" : ""}, ${steering}`;
    return this.described(answer, { name, seed: fields.seed ?? "0", version: this.version });
  }

  /** What runs and panels know of a flock, from the simulator's answer. */
  described({ parameters, lengths }, named) {
    const { n_leaders: leaders, target } = parameters;
    const targets = [target].flat();
    const isCommon = leaders > 0 && new Set(targets).size === 1;
    return {
      ...named, lengths, leaders, boats: parameters.n_boats, bw_s: parameters.bw_s, stored: parameters,
      parameters: Object.fromEntries(Object.keys(this.kinds).map((each) => [each, textOf(parameters[each])])),
      target: isCommon ? targets[0] : null, targets: leaders > 0 && !isCommon ? targets : undefined,
      ...Object.fromEntries(Object.entries(parameters).filter(([each]) => this.kinds[each] === "rows")), phases: this.phases, ids: null, every: 1,
    };
  }

  /** What the controls show. */
  get controlled() {
    const { flock, beside } = this.shown;
    const target = this.values.target.includes(",") ? "opposed" : this.values.target;
    const differs = Object.entries(beside ?? {}).map(([name, value]) => `${name}=${value}`).join(" ");
    return { ...this.values, target, preset: flock.preset ?? "simulation", leaders: this.policy, beside: differs };
  }
}
