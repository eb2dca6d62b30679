// A training that the visitor starts: leaders learn to choose rudders, and are judged at intervals in other flocks.

import { byId, fixed, withSign } from "../flockenv/replay/shared/words.mjs";
import { SAMPLING } from "./flocks.mjs";
import { TRAINED } from "./laws.mjs";
import { LearningCurve } from "./learning_curve.mjs";
import { requestOf } from "./request.mjs";
import { download, showTexts } from "./share.mjs";
import { Simulator } from "./simulator.mjs";
import { trainingCommand } from "./texts.mjs";

/** Settings in which trainings differ from `flockenv train --algorithm branches` with rudders. */
export const SETTINGS = { flock_hours: 60, hold_s: 0.8, seen_s: 0.8, trial_s: 8, branch_s: 16, offset: 1, step: 0.03 };
/** Duration of a judging flock in s, and the number of judgments in a training. */
const [JUDGED_SECONDS, JUDGMENTS] = [120, 12];
/** Time in ms between two sentences for screen readers. */
const SAY_EVERY = 5000;

export class Training {
  /** The training's progress; null before the first report. */
  progress = null;
  /** The last policy of the previous training; null without one. */
  before = null;
  seed = 0;
  isRunning = false;
  settings = { ...SETTINGS };
  /** Time in ms that the training runs between two reports. */
  slice = 200;
  /** Number of judging flocks, with seeds from 0 on. */
  judges = 64;
  curve = new LearningCurve(byId("curve"));
  #page;
  #simulator;
  /** The flock that is trained, as links have it, and the request for the judging flocks. */
  #trained = null;
  #judged = null;
  #isAtWork = false;
  #saidAt = -Infinity;

  constructor(page) {
    this.#page = page;
    this.#simulator = new Simulator(page.simulator.script, page.simulator.bytes);
  }

  /** Starts a training of the shown flock, stops the training, or continues it. */
  async toggle() {
    this.isRunning = !this.isRunning;
    this.show();
    if (!this.isRunning || this.#isAtWork) {
      return;
    }
    this.#isAtWork = true;
    try {
      await this.#run();
      this.#say(this.progress.has_ended ? `The training is over. ${this.#words} These are the last leaders, not the best.` : `Stopped. ${this.#words}`);
    } catch (error) {
      // What was learned until now can still be saved.
      this.before = this.progress?.policy ?? this.before;
      this.progress = null;
      this.#say(`No training: ${error.message}.`);
    }
    this.isRunning = this.#isAtWork = false;
    this.show();
    showTexts(this.#page.flocks, this.#page.time);
  }

  /** Stops the training if the shown flock's leaders are not trained; returns a sentence about that, or empty text. */
  leave() {
    if (!this.isRunning || this.#page.flocks.areTrained) {
      return "";
    }
    this.isRunning = false;
    return "The training waits in its lesson.";
  }

  async #run() {
    if (!this.progress || this.progress.has_ended || this.#isOther) {
      await this.#start();
    }
    while (this.isRunning && !this.progress.has_ended) {
      const { training } = await this.#simulator.ask("learn", { milliseconds: this.slice });
      await this.#report(training);
    }
  }

  /** The shown flock, as links have it, without the seed and the policy. */
  get #flock() {
    const { seed: _, leaders: __, ...flock } = this.#page.shown.flock;
    return flock;
  }

  /** Whether another flock is shown than the one that is trained. */
  get #isOther() {
    return JSON.stringify(this.#flock) !== JSON.stringify(this.#trained);
  }

  async #start() {
    const { flocks, about } = this.#page;
    this.seed = this.progress?.has_ended && !this.#isOther ? this.seed + 1 : 0;
    this.before = this.progress?.policy ?? this.before;
    this.show();
    this.#trained = this.#flock;
    const flock = requestOf(this.#trained, flocks.kinds);
    const provenance = {
      command: trainingCommand(this.#trained, flocks.values, this.settings, this.seed),
      flockenv: about.version, results_version: about.results_version,
    };
    if (!this.#simulator.worker) {
      await this.#simulator.start();
    }
    const request = { flock: { ...flock, seed: String(this.seed) }, options: this.settings, provenance };
    const { training } = await this.#simulator.ask("train", { request });
    this.#say("Measuring how the paper's law leads.");
    this.#judged = { ...flock, parameters: { ...flock.parameters, ...training.physics } };
    this.curve.clear(training.end, await this.#judge({ leaders: flocks.laws.atEverySubstep }));
    await this.#report(training);
  }

  /** Shows the training's progress, and judges its policy if that is due. */
  async #report(training) {
    this.progress = training;
    await this.#page.flocks.teach(training.policy);
    if (training.hours >= this.curve.next(JUDGMENTS)) {
      this.curve.add(training.hours, await this.#judge({ leaders: TRAINED, trained: training.policy }));
    }
    const isDue = performance.now() - this.#saidAt > SAY_EVERY;
    this.#say(`${fixed(training.hours, 0)} of ${fixed(training.end, 0)} flock-hours. ${this.#words}`, isDue);
    this.show();
  }

  /** Mean signed order over the judging flocks, which have the training's physics. `steering`: fields of the request that say how leaders steer. */
  async #judge(steering) {
    const { series } = this.#page.flocks;
    let sum = 0;
    for (let seed = 0; seed < this.judges; seed += 1) {
      const request = { ...this.#judged, ...steering, seed: String(seed) };
      const question = { request, samples: SAMPLING * JUDGED_SECONDS, index: series.indexOf("signed_order"), quantities: series.length };
      sum += (await this.#simulator.ask("judge", question)).mean;
    }
    return sum / this.judges;
  }

  get #words() {
    const { last, law } = this.curve;
    return `Signed order in ${this.judges} other flocks: your leaders ${withSign(last, 2)}, the paper's law ${withSign(law, 2)}.`;
  }

  /** Draws the curve, and updates the buttons. */
  show() {
    byId("train").textContent = this.isRunning ? "stop" : this.#next;
    byId("save-policy").disabled = !this.progress;
    byId("save-before").hidden = !this.before;
    this.draw();
  }

  get #next() {
    if (!this.progress) {
      return "train";
    }
    if (this.#isOther) {
      return "train again, this flock";
    }
    return this.progress.has_ended ? "train again, other seed" : "go on";
  }

  draw() {
    this.curve.draw(this.#page.view.palette);
    byId("curve").setAttribute("aria-label", this.progress ? `Learning curve. ${this.#words}` : "Learning curve: nothing has been learned yet");
  }

  /** Saves a policy through the browser. */
  save(policy = this.progress.policy) {
    download(new TextEncoder().encode(policy), "policy.json");
    this.#page.say("policy.json holds your leaders: flockenv run --policy policy.json leads a flock with them.");
  }

  /** Shows a sentence beside the curve and, if `isDue`, to screen readers. */
  #say(words, isDue = true) {
    byId("trained").textContent = words;
    if (isDue) {
      this.#saidAt = performance.now();
      byId("trained-said").textContent = words;
    }
  }
}
