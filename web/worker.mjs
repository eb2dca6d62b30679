// The simulator's own thread: answers one message after another, so that drawing never waits.

import { Core, Refusal } from "./core.mjs";

/** Substeps times boats between two readings of the clock: some milliseconds. */
const WORK = 20_000;
/** Samples of one flock before the next flock's turn. */
const TURN = 4;

let core = null;
let shown = [];

const ANSWERS = {
  async start({ bytes }) {
    core = await Core.load(bytes);
    return { text: core.describe() };
  },

  check: ({ request }) => ({ values: core.check(request) }),

  /** The rows of all quantities, in the order of their names, from the recorded ones of so many samples. */
  derive({ names, recorded, samples, sign }) {
    const { psi_o: order, phi_o: angle } = recorded;
    const rows = Array.from({ length: samples }, (_, k) =>
      names.map((name, place) => recorded[name]?.[k] ?? core.derived(place, order[k], angle[k], sign)));
    return { series: Float64Array.from(rows.flat()) };
  },

  /** Starts all flocks again. */
  open: ({ requests }) => ({ continues: false, values: opened(requests), taken: taken(requests.length) }),

  /** Changes all flocks; they start again together where one of them has to. */
  change({ requests }) {
    try {
      const said = requests.map((request, flock) => core.change(flock, request));
      shown = requests;
      const continues = said.every((text) => text.startsWith("continued"));
      const values = continues ? said.map((text) => text.slice(text.indexOf("\n") + 1)) : opened(requests);
      return { continues, values, taken: taken(requests.length) };
    } catch (refusal) {
      opened(shown);
      throw refusal;
    }
  },

  /** Takes samples of all flocks, up to so many within so many milliseconds. */
  advance({ samples, milliseconds, boat, rudder }) {
    const start = performance.now();
    core.steer(0, rudder);
    for (let left = samples; left > 0 && performance.now() - start < milliseconds; left -= TURN) {
      for (const flock of shown.keys()) {
        for (let missing = Math.min(TURN, left); missing > 0;) {
          missing -= core.advance(flock, missing, WORK);
        }
      }
    }
    return { ...ANSWERS.look({ boat }), milliseconds: performance.now() - start, memory: core.memory };
  },

  /** The contacts, and what a boat observes, as they are now. */
  look({ boat }) {
    for (const flock of shown.keys()) {
      core.look(flock, boat);
    }
    return { taken: taken(shown.length) };
  },
};

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
    postMessage({ id, said }, (said.taken ?? []).flatMap((each) => Object.values(each).map(({ buffer }) => buffer)));
  } catch (error) {
    postMessage({ id, error: { refused: error instanceof Refusal, field: error.field ?? "", words: error.message } });
  }
}

addEventListener("message", answer);
