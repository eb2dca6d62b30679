// The clock of the page: flocks that go on while it plays, and a game that ends.

import { Transport } from "../flockenv/replay/shared/transport.mjs";
import { fixed } from "../flockenv/replay/shared/words.mjs";
import { GAME_SECONDS } from "./lessons.mjs";
import { verdict } from "./rudder.mjs";

/** How long the simulator may compute for one frame, in ms, and after how long it is called slow. */
const [FRAME_WORK, SLOW] = [12, 1000];
/** Seconds after the start that the map leaves out: boats start at random and at rest. */
const SETTLING = 30;
/** The number of no boat. */
const NO_BOAT = 1e6;

export class Playback {
  time = 0;
  advancing = false;
  costs = { frames: 0, drawing: 0, simulating: 0, memory: 0 };
  #page;
  #rate = { since: 0, passed: 0, words: "" };
  #isOver = false;

  /** `page`: what is played, and says what there is to say. */
  constructor(page) {
    this.#page = page;
    this.transport = new Transport(document.getElementById("play"), (passed, now) => this.#tick(passed, now));
  }

  /** Other flocks, at their present. */
  restart() {
    this.time = this.#page.runs[0].end;
    this.#isOver = false;
  }

  toggle() {
    const { broken, flocks, runs, simulator } = this.#page;
    if (this.transport.playing && simulator.waiting > SLOW) {
      simulator.stop("you stopped it in the middle of a step");
    } else if (this.transport.playing) {
      this.transport.pause();
      this.show();
    } else if (!broken) {
      if (flocks.isRecorded && this.time >= runs[0].end) {
        this.time = runs[0].time[0];
      }
      this.transport.play();
    }
  }

  seek(time) {
    const [run] = this.#page.runs;
    this.time = Math.min(Math.max(time, run.time[0]), run.end);
    this.transport.pause();
    this.show();
  }

  #tick(passed, now) {
    const { flocks, other } = this.#page;
    const speed = other.speed === "max" ? Infinity : Number(other.speed);
    const { end } = flocks.runs[0];
    const from = this.time;
    this.time = Math.min(this.time + (passed > 0 ? passed * speed : 0), end);
    this.#note(now, this.time - from);
    if (flocks.isRecorded) {
      if (this.time >= end) {
        this.transport.pause();
      }
    } else if (!this.#judge()) {
      const ahead = speed === Infinity ? Infinity : this.time + 0.1 + 0.05 * speed - end;
      this.#advance(Math.ceil(Math.min(10 * ahead, 1e6)));
    }
    this.show(now);
  }

  /** Has the simulator take some more samples, unless it is at work already. */
  async #advance(samples) {
    const { hand, runs, simulator, view } = this.#page;
    if (simulator.waiting > SLOW) {
      this.#page.say("The simulator is busy with one step: pause stops it.");
    }
    if (this.advancing || this.#page.changing || samples <= 0) {
      return;
    }
    this.advancing = true;
    const question = { samples, milliseconds: FRAME_WORK, boat: view.pinned ?? NO_BOAT, rudder: hand.value };
    await this.#page.attempt(async () => {
      const { taken, milliseconds, memory } = await simulator.ask("advance", question);
      this.costs.simulating += milliseconds;
      this.costs.memory = memory;
      // The flocks may have become others meanwhile.
      if (runs === this.#page.runs) {
        taken.forEach((each, place) => {
          runs[place].append(each, place === 0 && runs[0].end > SETTLING ? (order) => view.map.note(runs[0].bw_s, order) : undefined);
        });
        view.observed = taken[0].observation;
      }
      if (!this.transport.playing) {
        this.show();
      }
    });
    this.advancing = false;
  }

  /** Whether the lesson that is a game ends, between two answers of the simulator. */
  #judge() {
    const { flocks, other } = this.#page;
    const [yours, law] = flocks.runs;
    if (other.lesson !== "steer" || !flocks.areYours || this.#isOver || this.advancing) {
      return false;
    }
    const words = verdict(yours.mean("signed_order"), law.mean("signed_order"), this.time, GAME_SECONDS);
    if (words) {
      this.#isOver = true;
      this.transport.pause();
      this.#page.say(`${words} “Again” starts another round.`);
    }
    return words !== null;
  }

  /** Counts frames, and what of time passed in them. */
  #note(now, passed) {
    this.costs.frames += 1;
    this.#rate.passed += passed;
    if (now - this.#rate.since > 1000) {
      const rate = (1000 * this.#rate.passed) / (now - this.#rate.since);
      this.#rate = { since: now, passed: 0, words: `${fixed(rate, rate < 10 ? 1 : 0)} × real time` };
    }
  }

  show(now = performance.now()) {
    const { flocks, view } = this.#page;
    if (flocks.runs.length > 0) {
      const start = performance.now();
      const isPlaying = this.transport.playing;
      view.show(this.time, { now, isPlaying, rate: isPlaying && !flocks.isRecorded ? this.#rate.words : "" });
      this.costs.drawing += performance.now() - start;
    }
  }
}
