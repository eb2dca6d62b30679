// The page: the visitor's actions, applied to the flocks.

import { LinkWriter } from "../flockenv/replay/shared/link.mjs";
import { byId } from "../flockenv/replay/shared/words.mjs";
import { Controls } from "./controls.mjs";
import { changed, Flocks } from "./flocks.mjs";
import { follow, linkOf } from "./follow.mjs";
import { Helm } from "./helm.mjs";
import { RECORDING } from "./lessons.mjs";
import { Playback } from "./playback.mjs";
import { quantitiesOf } from "./quantities.mjs";
import { readLink } from "./request.mjs";
import { showTexts } from "./share.mjs";
import { View } from "./view.mjs";

/** Time in ms after which the page says that a flock runs ahead. */
const RUNS_LONG = 500;

export class LivePage {
  /** The parts of the link besides the flocks. */
  other = { speed: "8" };
  /** Changes, [name, value], that wait until the present one is finished. */
  waitingChanges = [];
  changing = false;
  broken = false;
  /** Number of the latest link; earlier links are no longer followed. */
  latestLink = 0;
  /** Whether the page paused by itself, for a link that asks for a still picture or for a round of the game. */
  isHeld = false;
  link = new LinkWriter(() => (this.recorded || this.changing ? null : linkOf(this.flocks, this.other, this.playing ? 0 : this.time)));

  constructor(simulator, about, description) {
    this.simulator = simulator;
    this.about = about;
    this.entries = description.entries;
    this.kinds = Object.fromEntries(description.fields.map(({ name, kind }) => [name, kind]));
    this.quantities = quantitiesOf(description);
    const series = this.quantities.map(({ key }) => key);
    this.flocks = new Flocks(simulator, { ...description, kinds: this.kinds, series, version: about.version });
    this.view = new View(this.flocks, this, about.orders, (time) => this.seek(time));
    this.playback = new Playback(this);
    this.helm = new Helm(byId("thumb"), byId("heading"), () => this.flocks.areYours, () => this.playback.start());
    const meanings = Object.fromEntries(description.fields.map(({ name, meaning }) => [name, meaning]));
    this.controls = new Controls(meanings, this.flocks.laws, (name, value) => this.set(name, value));
  }

  get runs() {
    return this.flocks.runs;
  }

  get shown() {
    return this.flocks.shown;
  }

  get playing() {
    return this.playback.transport.playing;
  }

  get time() {
    return this.playback.time;
  }

  get recorded() {
    return this.flocks.isRecorded;
  }

  /** Shows the flocks of a link. */
  async follow(fragment) {
    const [link, start] = [this.latestLink + 1, performance.now()];
    this.latestLink = link;
    const isWanted = () => {
      if (performance.now() - start > RUNS_LONG) {
        this.say("The flock runs ahead to the moment of the link.");
      }
      return link === this.latestLink;
    };
    this.changing = true;
    const linked = readLink(fragment, Object.keys(this.kinds));
    this.#showOther(linked.other);
    await this.attempt(() => follow(this.flocks, linked, isWanted));
    if (isWanted() && !this.broken) {
      this.changing = false;
      this.playback.hold(linked.other.paused === "1");
      this.#showAnswer("open", { continues: false, words: linked.ignored.join(" ") });
      await this.#change();
    }
  }

  /** Applies the parts of a link besides the flocks. */
  #showOther({ start: _, now: __, flocks: ___, paused: ____, ...other }) {
    this.other = { speed: "8", ...other };
    this.view.choose(this.other);
  }

  /** Changes one parameter; the flock continues from its present state if that is possible. */
  set(name, value) {
    this.waitingChanges = [...this.waitingChanges.filter(([other]) => other !== name), [name, value]];
    this.#change();
  }

  /** Starts again, with this seed. */
  async restart(seed = this.flocks.requested.flock.seed) {
    this.latestLink += 1;
    this.changing = false;
    const flock = { ...this.flocks.requested.flock, ...(seed !== undefined && { seed }) };
    await this.attempt(() => this.#update({ ...this.flocks.requested, flock }, "open"));
  }

  /** Returns from a recording, or restarts: with a new thread if the old one stopped, and after a round with the next round's flocks. */
  async again() {
    if (this.recorded && !this.broken) {
      this.playback.returnToFlocks();
      return;
    }
    if (this.broken) {
      this.broken = false;
      await this.attempt(() => this.simulator.start());
    }
    if (!this.broken) {
      const { seed = "0" } = this.flocks.requested.flock;
      await this.restart(this.playback.isOver ? String(BigInt(seed) + BigInt(this.flocks.shown.copies)) : undefined);
    }
  }

  /** Makes the waiting changes, one request at a time. Of changes with the same name only the last one counts. */
  async #change() {
    if (this.changing) {
      return;
    }
    this.changing = true;
    while (this.waitingChanges.length > 0) {
      const { requested, isRecorded, laws, values } = this.flocks;
      const wanted = this.waitingChanges.reduce((base, [name, value]) => changed(base, values, laws, name, value), requested);
      this.waitingChanges = [];
      const isSameKind = !isRecorded && JSON.stringify(wanted.beside) === JSON.stringify(requested.beside);
      await this.attempt(() => this.#update(wanted, isSameKind ? "change" : "open"));
    }
    this.changing = false;
  }

  /** Makes a call of the simulator, and says why if it refuses or stops. */
  async attempt(call) {
    try {
      await call();
    } catch (error) {
      if (error.refused) {
        this.say(`${error.message}.`);
        this.controls.show(this.flocks.controlValues);
      } else {
        this.#stop(error);
      }
    }
  }

  /** Lets the simulator open or change the flocks, and shows them. */
  async #update(wanted, kind) {
    this.#showAnswer(kind, { continues: await this.flocks.update(wanted, kind) });
  }

  /** Shows the flocks after they were opened or changed. After a change it says whether they continue, otherwise `words`. */
  #showAnswer(kind, { continues, words = "" }) {
    if (!continues) {
      this.playback.restart();
    }
    this.showRuns();
    const changeWords = continues ? "The flock continues from where it is." : "The flock starts again: it cannot continue with this change.";
    this.say(kind === "change" ? changeWords : words);
    this.link.write();
  }

  /** Shows the present runs, and everything that depends on them. */
  showRuns() {
    this.view.showLesson(this.recorded ? RECORDING : this.other.lesson ?? "");
    this.view.rebuild((boat) => this.pin(boat), () => this.show());
    const { pinned } = this.view;
    this.pin(pinned !== null && pinned < this.runs[0].boats ? pinned : null);
    this.controls.show(this.flocks.controlValues);
    showTexts(this.flocks, this.time);
    this.training.show();
  }

  /** Shows a sentence. A training stops if the shown flock is not trained, and the sentence says so. */
  say(words) {
    byId("status").textContent = `${words} ${this.training.leave()}`.trim();
  }

  #stop(error) {
    this.playback.transport.pause();
    this.broken = true;
    this.say(`The simulator stopped: ${error.message}. “Again” starts it again.`);
  }

  toggle() {
    this.playback.toggle();
  }

  seek(time) {
    this.playback.seek(time);
  }

  show(now = performance.now()) {
    this.playback.show(now);
  }

  /** Shows a boat's numbers and its local frame; null for none. */
  pin(boat) {
    this.view.pinned = boat;
    this.view.observed = null;
    this.view.showWordsNow();
    byId("boat").value = boat ?? "";
    this.remember("boat", boat === null ? null : String(boat));
    if (boat !== null && !this.playing && !this.recorded) {
      this.#observe(boat);
    }
  }

  /** Stores a setting of the page, such as its speed, in the link; null removes it. */
  remember(name, value) {
    if (value === null) {
      delete this.other[name];
    } else {
      this.other[name] = value;
    }
    this.link.write();
    this.show();
  }

  /** Asks the simulator what a boat observes while the flock is paused. */
  async #observe(boat) {
    await this.attempt(async () => {
      const { taken } = await this.simulator.ask("look", { boat });
      if (boat === this.view.pinned) {
        this.view.observed = taken[0].observation;
        this.show();
      }
    });
  }
}
