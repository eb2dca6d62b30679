// The simulator's thread: answers one message after another, so that drawing need not wait.

import { Core, Refusal } from "./core.mjs";

/** Work limit of a call in substeps times boats: some milliseconds. */
const WORK = 20_000;
/** Largest number of samples of one flock before the next flock advances. */
const TURN = 4;

let core = null;
/** A second instance of the simulator, which tries requests. */
let trial = null;
let shown = [];

/** Answers of the thread, by the kind of question. */
export const ANSWERS = {
  async start({ bytes }) {
    [core, trial] = await Promise.all([Core.load(bytes), Core.load(bytes)]);
    return { described: core.describe() };
  },

  check: ({ request }) => ({ values: core.check(request) }),

  /**
   * All quantities of a number of samples, in the order of their `names`, for the flock that was checked last.
   * Recorded quantities come from the request or are computed from the `states`; the others are derived from them.
   */
  derive({ names, recorded, states, samples, sign }) {
    const rows = Array.from({ length: samples }, (_, k) => {
      const computed = states ? core.recorded(states[k]) : null;
      const value = (name, index) => recorded[name]?.[k] ?? computed?.[index] ?? NaN;
      const [order, angle] = ["psi_o", "phi_o"].map((name) => value(name, names.indexOf(name)));
      return names.map((name, index) => {
        const derived = core.derived(index, order, angle, sign);
        return Number.isNaN(derived) ? value(name, index) : derived;
      });
    });
    return { series: Float64Array.from(rows.flat()) };
  },

  /** Starts all flocks again. After a refusal those before continue as they were. */
  open({ requests }) {
    tryLater(requests);
    const values = openAll(requests);
    return { continues: false, values, taken: takeAll(requests.length) };
  },

  /** Changes all flocks; if one of them has to start again, all do. After a refusal all continue as they were. */
  change({ requests }) {
    tryLater(requests);
    const answers = requests.map((request, flock) => core.change(flock, request));
    shown = requests;
    const continues = answers.every(({ continued }) => continued);
    const values = continues ? answers : openAll(requests);
    return { continues, values, taken: takeAll(requests.length) };
  },

  /** Advances all flocks by up to `samples` samples, for about `milliseconds`. Leaders that the visitor steers get this `heading`. */
  advance({ samples, milliseconds, boat, heading }) {
    const start = performance.now();
    for (const flock of shown.keys()) {
      core.steer(flock, heading);
    }
    for (let remaining = samples; remaining > 0 && performance.now() - start < milliseconds; remaining -= TURN) {
      for (const flock of shown.keys()) {
        advanceBy(flock, Math.min(TURN, remaining));
      }
    }
    return { ...ANSWERS.look({ boat }), milliseconds: performance.now() - start, memory: core.memory };
  },

  /** Gives leaders that the visitor trains this policy. */
  teach({ policy }) {
    shown.forEach((request, flock) => {
      if (request.leaders === "trained") {
        core.change(flock, Object.assign(request, { trained: policy }));
      }
    });
    return {};
  },

  train: ({ request }) => ({ training: core.train(request) }),

  /** Continues the training for this many milliseconds, or to its end. */
  learn({ milliseconds }) {
    const start = performance.now();
    let training = core.learn(1);
    while (!training.has_ended && performance.now() - start < milliseconds) {
      training = core.learn(1);
    }
    return { training };
  },

  /** The mean of a quantity over the first `samples` samples of a flock; `index`: its index among the `quantities` of a sample. */
  judge({ request, samples, index, quantities }) {
    core.open(0, request);
    core.take(0);
    advanceBy(0, samples);
    const values = core.take(0).series.filter((_, position) => position % quantities === index);
    core.close(0);
    return { mean: values.reduce((sum, value) => sum + value, 0) / values.length };
  },

  /** The samples since the last call, with the present contacts and a boat's present observation. */
  look({ boat }) {
    for (const flock of shown.keys()) {
      core.look(flock, boat);
    }
    return { taken: takeAll(shown.length) };
  },
};

/** Advances a flock by a number of samples. */
function advanceBy(flock, samples) {
  for (let missing = samples; missing > 0;) {
    missing -= core.advance(flock, missing, WORK);
  }
}

/** Throws the refusal of a request after the first. The simulator leaves a flock as it is when it refuses; the flocks before it would have changed. */
function tryLater(requests) {
  for (const request of requests.slice(1)) {
    trial.open(0, request);
    trial.close(0);
  }
}

/** Starts all flocks again; returns their parameters. */
function openAll(requests) {
  const values = requests.map((request, flock) => core.open(flock, request));
  shown = requests;
  return values;
}

/** The columns of all flocks since the last call. */
function takeAll(flocks) {
  return Array.from({ length: flocks }, (_, flock) => core.take(flock));
}

async function reply({ data: { id, kind, ...message } }) {
  try {
    const answer = await ANSWERS[kind](message);
    postMessage({ id, answer }, (answer.taken ?? []).flatMap((columns) => Object.values(columns).map(({ buffer }) => buffer)));
  } catch (error) {
    postMessage({ id, error: { refused: error instanceof Refusal, field: error.field ?? "", words: error.message } });
  }
}

addEventListener("message", reply);
