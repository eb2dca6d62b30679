// The clock of the page: advances flocks while it plays, and ends rounds of the game.

import { Transport } from "../flockenv/replay/shared/transport.mjs";
import { byId, fixed } from "../flockenv/replay/shared/words.mjs";
import { NO_BOAT } from "./flocks.mjs";
import { Game, scoreOf } from "./game.mjs";

/** How long the simulator may compute for one frame, in ms, and after how long it is called slow; its first answer takes longer. */
const [FRAME_WORK, SLOW, SLOW_AT_FIRST] = [12, 1000, 8000];

/** Whether the system asks for reduced motion, and the sentence for that. */
export const wantsLessMotion = () => matchMedia("(prefers-reduced-motion: reduce)").matches;
export const PAUSED = "Paused, since your system asks for less motion: the button or the space bar plays.";

export class Playback {
  time = 0;
  advancing = false;
  costs = { frames: 0, drawing: 0, simulating: 0, memory: 0 };
  game = new Game();
  #page;
  #rate = { since: 0, passed: 0, words: "" };
  #isOver = false;
  /** The time of the flocks that wait while a recording is shown; null without a recording. */
  #left = null;

  /** `page` has the flocks to play, and shows sentences. */
  constructor(page) {
    this.#page = page;
    this.transport = new Transport(byId("play"), (passed, now) => this.#tick(passed, now));
  }

  /** Shows other flocks, at their latest sample. */
  restart() {
    const { flocks, hand, view } = this.#page;
    this.time = flocks.runs[0].end;
    this.#isOver = false;
    this.#left = null;
    if (flocks.areYours) {
      hand.center();
      this.game.play(flocks.shown.flock);
      view.rounds = this.game.words;
    }
  }

  /** Shows a recording's run at its start; the flocks wait where they are. */
  begin(run) {
    const { flocks, isHeld, view: { pinned } } = this.#page;
    this.#left ??= { time: this.time, isHeld, pinned, isOver: this.#isOver, plays: this.transport.playing };
    this.#isOver = false;
    this.transport.pause();
    flocks.show(run);
    // Its picture must come first, since the pictures of the flocks have no run any more.
    this.#page.showRuns();
    this.seek(run.time[0]);
  }

  /** Continues with the flocks that waited. */
  comeBack() {
    const { time, isHeld, pinned, isOver, plays } = this.#left;
    this.#left = null;
    this.transport.pause();
    this.#page.flocks.comeBack();
    Object.assign(this, { time });
    this.#isOver = isOver;
    this.#page.isHeld = isHeld;
    this.#page.view.pinned = pinned;
    this.#page.showRuns();
    this.#page.say("");
    if (plays) {
      this.transport.play();
    }
  }

  /** Whether what is shown is the game. */
  get #isGame() {
    return this.#page.other.lesson === "steer" && this.#page.flocks.areYours;
  }

  /** Pauses if the link asks for a still picture or starts a round of the game, which wait for the visitor; otherwise plays again. */
  hold(isStill) {
    const wasHeld = this.#page.isHeld;
    this.#page.isHeld = isStill || this.#isGame;
    if (this.#page.isHeld) {
      this.transport.pause();
    } else if (wasHeld && !this.transport.playing && !wantsLessMotion()) {
      this.transport.play();
    }
  }

  /** The visitor has steered: starts a round of the game that waits for it. */
  start() {
    if (this.#page.flocks.areYours && !this.#isOver && !this.transport.playing) {
      this.toggle();
    }
  }

  /** Whether a round of the game is over. */
  get isOver() {
    return this.#isOver;
  }

  toggle() {
    const { broken, flocks, runs, simulator } = this.#page;
    this.#page.isHeld = false;
    if (this.transport.playing && this.#isSlow(simulator)) {
      simulator.stop("you stopped it in the middle of a step");
    } else if (this.transport.playing) {
      this.transport.pause();
      this.#page.link.write();
      this.show();
    } else if (this.#isOver) {
      this.#page.again().then(() => this.transport.play());
    } else if (!broken) {
      if (byId("status").textContent === PAUSED) {
        this.#page.say("");
      }
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
    const { changing, flocks, other } = this.#page;
    if (changing) {
      return;
    }
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

  #isSlow({ waiting }) {
    return waiting > (this.costs.simulating > 0 ? SLOW : SLOW_AT_FIRST);
  }

  /** Asks the simulator for some more samples, unless it is at work. */
  async #advance(samples) {
    const { flocks, hand, simulator, view } = this.#page;
    if (this.#isSlow(simulator)) {
      this.#page.say("The simulator is busy with one step: pause stops it.");
    }
    if (this.advancing || this.#page.changing || samples <= 0) {
      return;
    }
    this.advancing = true;
    const question = { samples, milliseconds: FRAME_WORK, boat: view.pinned ?? NO_BOAT, heading: hand.value };
    await this.#page.attempt(async () => {
      const { taken, milliseconds, memory } = await flocks.advance(question, (noise, order) => view.map.note(noise, order));
      this.costs.simulating += milliseconds;
      this.costs.memory = memory;
      view.observed = taken[0].observation;
      if (!this.transport.playing) {
        this.show();
      }
    });
    this.advancing = false;
  }

  /** Whether a round of the game ends, between two answers of the simulator. */
  #judge() {
    const { flocks, view } = this.#page;
    if (!this.#isGame || this.#isOver || this.advancing || !Game.isOver(this.time)) {
      return false;
    }
    const { runs, besides } = flocks;
    this.#isOver = true;
    this.#page.isHeld = true;
    this.transport.pause();
    this.#page.say(this.game.end(scoreOf(runs.slice(0, besides)), scoreOf(runs.slice(besides))));
    view.rounds = this.game.words;
    return true;
  }

  /** Counts frames, and the time that passed in them. */
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
    // Flocks that have not started yet have no pictures.
    if (view.panels.length > 0) {
      const start = performance.now();
      const isPlaying = this.transport.playing;
      view.show(this.time, { now, isPlaying, rate: isPlaying && !flocks.isRecorded ? this.#rate.words : "" });
      this.costs.drawing += performance.now() - start;
    }
  }
}
