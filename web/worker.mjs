// The simulator's own thread: answers one message after another, so that drawing never waits.

import { Core, Refusal } from "./core.mjs";

/** Substeps times boats between two readings of the clock: some milliseconds. */
const WORK = 20_000;
/** Samples of one flock before the next flock's turn. */
const TURN = 4;

let core = null;
let shown = [];

/** Answers of the thread, by the kind of question. */
export const ANSWERS = {
  async start({ bytes }) {
    core = await Core.load(bytes);
    return { described: core.describe() };
  },

  check: ({ request }) => ({ values: core.check(request) }),

  /**
   * The rows of all quantities, in the order of their `names`, for a number of samples. Recorded quantities
   * come from the request or are computed from the `states`; the other quantities are derived from them. The
   * flock is the one that was checked last.
   */
  derive({ names, recorded, states, samples, sign }) {
    const rows = Array.from({ length: samples }, (_, k) => {
      const known = states ? core.recorded(states[k]) : null;
      const value = (name, index) => recorded[name]?.[k] ?? known?.[index] ?? NaN;
      const [order, angle] = ["psi_o", "phi_o"].map((name) => value(name, names.indexOf(name)));
      return names.map((name, index) => {
        const derived = core.derived(index, order, angle, sign);
        return Number.isNaN(derived) ? value(name, index) : derived;
      });
    });
    return { series: Float64Array.from(rows.flat()) };
  },

  /** Starts all flocks again. */
  open({ requests }) {
    const values = opened(requests);
    return { continues: false, values, taken: taken(requests.length) };
  },

  /** Changes all flocks; if one of them has to start again, all do. */
  change({ requests }) {
    try {
      const said = requests.map((request, flock) => core.change(flock, request));
      shown = requests;
      const continues = said.every(({ continued }) => continued);
      const values = continues ? said : opened(requests);
      return { continues, values, taken: taken(requests.length) };
    } catch (refusal) {
      opened(shown);
      throw refusal;
    }
  },

  /** Takes up to this many samples of all flocks, for at most this many milliseconds. */
  advance({ samples, milliseconds, boat, heading }) {
    const start = performance.now();
    for (const flock of shown.keys()) {
      core.steer(flock, heading);
    }
    for (let left = samples; left > 0 && performance.now() - start < milliseconds; left -= TURN) {
      for (const flock of shown.keys()) {
        advanced(flock, Math.min(TURN, left));
      }
    }
    return { ...ANSWERS.look({ boat }), milliseconds: performance.now() - start, memory: core.memory };
  },

  /** Lets the leaders that the visitor trains follow this policy from now on. */
  teach({ policy }) {
    shown.forEach((request, flock) => {
      if (request.leaders === "trained") {
        core.change(flock, Object.assign(request, { trained: policy }));
      }
    });
    return {};
  },

  train: ({ asked }) => ({ training: core.train(asked) }),

  /** Continues the training for this many milliseconds, or to its end. */
  learn({ milliseconds }) {
    const start = performance.now();
    let training = core.learn(1);
    while (!training.has_ended && performance.now() - start < milliseconds) {
      training = core.learn(1);
    }
    return { training };
  },

  /** The mean of the quantity at this index, of `quantities` in each sample, over the first `samples` samples of a flock. */
  judge({ request, samples, index, quantities }) {
    core.open(0, request);
    core.take(0);
    advanced(0, samples);
    const values = core.take(0).series.filter((_, position) => position % quantities === index);
    core.close(0);
    return { mean: values.reduce((sum, value) => sum + value, 0) / values.length };
  },

  /** The contacts, and a boat's observation, at this moment. */
  look({ boat }) {
    for (const flock of shown.keys()) {
      core.look(flock, boat);
    }
    return { taken: taken(shown.length) };
  },
};

function advanced(flock, samples) {
  for (let missing = samples; missing > 0;) {
    missing -= core.advance(flock, missing, WORK);
  }
}

function opened(requests) {
  const values = requests.map((request, flock) => core.open(flock, request));
  shown = requests;
  return values;
}

function taken(flocks) {
  return Array.from({ length: flocks }, (_, flock) => core.take(flock));
}

async function answer({ data: { id, kind, ...message } }) {
  try {
    const said = await ANSWERS[kind](message);
    postMessage({ id, said }, (said.taken ?? []).flatMap((columns) => Object.values(columns).map(({ buffer }) => buffer)));
  } catch (error) {
    postMessage({ id, error: { refused: error instanceof Refusal, field: error.field ?? "", words: error.message } });
  }
}

addEventListener("message", answer);
