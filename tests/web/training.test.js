// Law: a training whose thread ends keeps what it learned, and starts again.

import assert from "node:assert/strict";
import { test } from "node:test";

const elements = {};
globalThis.document = { getElementById: (id) => { elements[id] ??= { setAttribute: () => undefined, clientWidth: 0 }; return elements[id]; } };
globalThis.addEventListener = () => undefined;
URL.createObjectURL = () => "blob:";
URL.revokeObjectURL = () => undefined;

/** Threads that answer each question, until one that they do not know ends them. */
const threads = [];
globalThis.Worker = class {
  listeners = {};
  isOver = false;
  constructor() {
    threads.push(this);
  }
  addEventListener(kind, listener) {
    this.listeners[kind] = listener;
  }
  terminate() {
    this.isOver = true;
  }
  postMessage({ id, kind }) {
    if (this.isOver) {
      return;
    }
    const training = { policy: `policy ${threads.length}`, hours: 0, end: 60, has_ended: false, physics: {} };
    const answers = { start: {}, train: { training }, judge: { mean: 0.1 } };
    const say = () => (answers[kind] ? this.listeners.message({ data: { id, answer: answers[kind] } }) : this.listeners.error({ message: "out of memory" }));
    setTimeout(say);
  }
};

const { Training } = await import("../../web/training.mjs");
const { Simulator } = await import("../../web/simulator.mjs");

/** A page that shows a flock with leaders that are trained. */
function pageOf() {
  const shown = { flock: { leaders: "trained" }, beside: null, copies: 1 };
  const past = { first: shown, changes: [] };
  const flocks = { shown, past, kinds: {}, values: { n_boats: "9", n_leaders: "3", pool: "wide", bw_s: "0.3" }, series: ["signed_order"], laws: {}, areTrained: true, teach: async () => undefined, linkFields: () => ({ isComplete: true }) };
  return { simulator: {}, flocks, shown, about: {}, time: 0, view: {} };
}

test("a training whose thread ended", async () => {
  const training = new Training(pageOf());
  training.judges = 1;
  await training.toggle();
  assert.equal(elements.trained.textContent, "No training: out of memory.");
  assert.deepEqual([training.progress, training.before, training.isRunning], [null, "policy 1", false]);
  await training.toggle();
  assert.deepEqual([threads.length, training.before], [2, "policy 2"]);
});

test("a thread that has ended refuses questions at once", async () => {
  const simulator = new Simulator("", null);
  await simulator.start();
  simulator.stop("it took too long");
  await assert.rejects(simulator.ask("look", {}), /it is not running/);
  await simulator.start();
  assert.deepEqual(await simulator.ask("judge", {}), { mean: 0.1 });
});
