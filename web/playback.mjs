// The clock of the page: advances flocks while it plays, and ends rounds of the game.

import { Transport } from "../flockenv/replay/shared/transport.mjs";
import { byId, fixed } from "../flockenv/replay/shared/words.mjs";
import { NO_BOAT, SAMPLING } from "./flocks.mjs";
import { Game, scoreOf } from "./game.mjs";

/** Times in ms: how long the simulator may compute for one frame, after how long it counts as slow, and the same for its first answer. */
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
  /** The speed over about a second: its start in ms, the seconds that passed, and the last speed in words. */
  #rate = { since: 0, passed: 0, words: "" };
  #isOver = false;
  /** The state of playback to which the page returns from a recording; null without a recording. */
  #before = null;

  /** `page` has the flocks to play, and shows sentences. */
  constructor(page) {
    this.#page = page;
    this.transport = new Transport(byId("play"), (passed, now) => this.#tick(passed, now));
  }

  /** Goes to the latest sample of new flocks; centers your rudder and shows your score. */
  restart() {
    const { flocks, helm, view } = this.#page;
    this.time = flocks.runs[0].end;
    this.#isOver = false;
    this.#before = null;
    if (flocks.areYours) {
      helm.center();
      this.game.play(flocks.shown.flock);
      view.roundWords = this.game.words;
    }
  }

  /** Shows a recording's run from its start; the flocks wait. */
  begin(run) {
    const { flocks, isHeld, view: { pinned } } = this.#page;
    this.#before ??= { time: this.time, isHeld, pinned, isOver: this.#isOver, plays: this.transport.playing };
    this.#isOver = false;
    this.transport.pause();
    flocks.show(run);
    // The recording's picture must come first: the pictures of the flocks no longer have runs.
    this.#page.showRuns();
    this.seek(run.time[0]);
  }

  /** Continues with the flocks that waited. */
  returnToFlocks() {
    const { time, isHeld, pinned, isOver, plays } = this.#before;
    this.#before = null;
    this.transport.pause();
    this.#page.flocks.returnToFlocks();
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

  /** Whether the page shows the game. */
  get #isGame() {
    return this.#page.other.lesson === "steer" && this.#page.flocks.areYours;
  }

  /** Pauses for a still picture or a round of the game, until the visitor plays or steers. Otherwise goes on if the page had paused by itself. */
  hold(isStill) {
    const wasHeld = this.#page.isHeld;
    this.#page.isHeld = isStill || this.#isGame;
    if (this.#page.isHeld) {
      this.transport.pause();
    } else if (wasHeld && !this.transport.playing && !wantsLessMotion()) {
      this.transport.play();
    }
  }

  /** Starts a waiting round of the game, after the visitor has steered. */
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
    this.#countFrame(now, this.time - from);
    if (flocks.isRecorded) {
      if (this.time >= end) {
        this.transport.pause();
      }
    } else if (!this.#endRound()) {
      // The samples reach a little beyond the time that is drawn, the more the faster it plays.
      const missingSeconds = speed === Infinity ? Infinity : this.time + 0.1 + 0.05 * speed - end;
      this.#advance(Math.ceil(Math.min(SAMPLING * missingSeconds, 1e6)));
    }
    this.show(now);
  }

  #isSlow({ waiting }) {
    return waiting > (this.costs.simulating > 0 ? SLOW : SLOW_AT_FIRST);
  }

  /** Asks the simulator for more samples, unless an answer is due. */
  async #advance(samples) {
    const { flocks, helm, simulator, view } = this.#page;
    if (this.#isSlow(simulator)) {
      this.#page.say("The simulator is busy with one step: pause stops it.");
    }
    if (this.advancing || this.#page.changing || samples <= 0) {
      return;
    }
    this.advancing = true;
    const question = { samples, milliseconds: FRAME_WORK, boat: view.pinned ?? NO_BOAT, heading: helm.value };
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

  /** Ends a round of the game that is over, unless an answer of the simulator is due. Returns whether it ended. */
  #endRound() {
    const { flocks, view } = this.#page;
    if (!this.#isGame || this.#isOver || this.advancing || !Game.isOver(this.time)) {
      return false;
    }
    const { runs, firstBeside } = flocks;
    this.#isOver = true;
    this.#page.isHeld = true;
    this.transport.pause();
    this.#page.say(this.game.end(scoreOf(runs.slice(0, firstBeside)), scoreOf(runs.slice(firstBeside))));
    view.roundWords = this.game.words;
    return true;
  }

  /** Counts a frame, and measures the speed in s of the flock per s. */
  #countFrame(now, passed) {
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
