// The page: what a visitor may do, and the flocks that it does it to.

import { LinkWriter } from "../flockenv/replay/shared/link.mjs";
import { colorKey } from "../flockenv/replay/shared/panel.mjs";
import { byId, element } from "../flockenv/replay/shared/words.mjs";
import { Controls } from "./controls.mjs";
import { changed, Flocks } from "./flocks.mjs";
import { LESSONS } from "./lessons.mjs";
import { Playback } from "./playback.mjs";
import { linkTo, readLink, SPEEDS } from "./request.mjs";
import { Rudder } from "./rudder.mjs";
import { showTexts } from "./share.mjs";
import { View } from "./view.mjs";

export class LivePage {
  /** What the link holds besides the flocks. */
  other = { speed: "8" };
  /** What a change asks for that waits for the one before. */
  wanted = null;
  changing = false;
  broken = false;
  #link = new LinkWriter(() => (this.flocks.isRecorded ? null : linkTo({ ...this.flocks.shown, other: this.other })));

  constructor(simulator, about, described) {
    this.simulator = simulator;
    this.about = about;
    this.entries = described.entries;
    this.kinds = Object.fromEntries(described.fields.map(({ name, kind }) => [name, kind]));
    this.quantities = described.quantities.filter(({ kind }) => kind !== "structure").map(({ name, label, symbol, ...rest }) => ({
      ...rest, key: name, decimals: 2, words: label.replace(/^[^,]*/, (word) => `${word} ${symbol}`.trim()).replace("_o", "ₒ"),
    }));
    const series = this.quantities.map(({ key }) => key);
    this.flocks = new Flocks(simulator, { kinds: this.kinds, laws: described.laws, series, phases: described.phases, version: about.version });
    this.view = new View(this.flocks, this, about.orders, (time) => this.seek(time));
    this.hand = new Rudder(byId("thumb"), () => this.flocks.areYours);
    this.playback = new Playback(this);
    const meanings = Object.fromEntries(described.fields.map(({ name, meaning, accepted }) => [name, `${meaning} Accepted: ${accepted}`]));
    this.controls = new Controls(meanings, this.flocks.laws, (name, value) => this.set(name, value));
    byId("speed").append(...SPEEDS.map((each) => new Option(each === "max" ? "as fast as it goes" : `${each} ×`, each)));
    byId("color-key").append(...colorKey());
    byId("lessons").append(...LESSONS.map(({ name, title, link }) => {
      const anchor = element("a", "", title);
      Object.assign(anchor, { href: link });
      anchor.dataset.lesson = name;
      return anchor;
    }));
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

  /** Shows what a link asks for. */
  async follow(fragment) {
    const linked = readLink(fragment, Object.keys(this.kinds));
    const words = [...linked.ignored];
    const { start = "0", ...other } = linked.other;
    this.other = { speed: "8", ...other };
    byId("speed").value = this.other.speed;
    byId("forces").checked = this.other.forces === "1";
    byId("colors").value = this.other.colors ?? "direction";
    this.view.pinned = this.other.boat === undefined ? null : Number(this.other.boat);
    this.view.tell(this.other.lesson ?? "");
    const wanted = { flock: linked.flock, beside: linked.beside };
    // What the simulator refuses is left out, one parameter after another.
    for (let tries = 0; tries < 40; tries += 1) {
      try {
        await this.#become(wanted, "open", words, Number(start));
        return;
      } catch (error) {
        if (!error.refused) {
          this.#stop(error);
          return;
        }
        words.push(`The link asks for what cannot be: ${error.message}.`);
        const held = [wanted.flock, wanted.beside ?? {}].filter((fields) => Object.hasOwn(fields, error.field));
        if (held.length === 0) {
          Object.assign(wanted, { flock: {}, beside: null });
        }
        for (const fields of held) {
          delete fields[error.field];
        }
      }
    }
  }

  /** Changes one parameter, from where the flock is if that is possible. */
  set(name, value) {
    this.wanted = changed(this.wanted ?? this.flocks.asked, this.flocks.values, this.flocks.laws, name, value);
    this.#change();
  }

  /** Starts again, with this seed. */
  async restart(seed = this.flocks.asked.flock.seed) {
    const flock = { ...this.flocks.asked.flock, ...(seed !== undefined && { seed }) };
    await this.attempt(() => this.#become({ ...this.flocks.asked, flock }, "open", []));
  }

  /** Starts again, with a new thread where the old one stopped. */
  async again() {
    if (this.broken) {
      this.broken = false;
      await this.attempt(() => this.simulator.start());
    }
    if (!this.broken) {
      await this.restart();
    }
  }

  /** One change after another, the last of those that came meanwhile. */
  async #change() {
    if (this.changing) {
      return;
    }
    this.changing = true;
    while (this.wanted) {
      const wanted = this.wanted;
      this.wanted = null;
      const alike = JSON.stringify(wanted.beside) === JSON.stringify(this.flocks.asked.beside);
      await this.attempt(() => this.#become(wanted, alike && !this.flocks.isRecorded ? "change" : "open", []));
    }
    this.changing = false;
  }

  /** Asks the simulator, and says why if it refuses or stops. */
  async attempt(question) {
    try {
      await question();
    } catch (error) {
      if (error.refused) {
        this.say(`${error.message}.`);
        this.controls.show(this.flocks.controlled);
      } else {
        this.#stop(error);
      }
    }
  }

  /** Has the simulator open or change the flocks, and shows them. */
  async #become(wanted, kind, words, aheadSeconds = 0) {
    const hadFlock = this.flocks.shown !== null;
    const isSame = await this.flocks.become(wanted, kind, aheadSeconds);
    if (!isSame) {
      this.playback.restart();
    }
    if (hadFlock && kind === "change") {
      words.push(isSame ? "The flock continues from where it is." : "The flock starts again: it cannot continue with this change.");
    }
    this.showRuns();
    this.say(words.join(" "));
    this.#link.write();
  }

  /** Shows the runs that there are now. */
  showRuns() {
    this.view.rebuild((boat) => this.pin(boat), () => this.show());
    if (this.flocks.areYours) {
      this.view.pinned = 0;
    }
    const { pinned } = this.view;
    this.pin(pinned !== null && pinned < this.runs[0].boats ? pinned : null);
    this.controls.show(this.flocks.controlled);
    for (const link of byId("story").querySelectorAll("a")) {
      const { flock } = readLink(link.hash, Object.keys(this.kinds));
      link.setAttribute("aria-current", String(Object.entries(flock).every(([name, value]) => this.shown.flock[name] === value)));
    }
    showTexts(this.flocks);
  }

  say(words) {
    byId("status").textContent = words;
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
    byId("boat").value = boat ?? "";
    this.remember("boat", boat === null ? null : String(boat));
    if (boat !== null && !this.playing && !this.flocks.isRecorded) {
      this.#look(boat);
    }
  }

  /** Keeps something else than the flocks in the link; null for the default. */
  remember(name, value) {
    if (value === null) {
      delete this.other[name];
    } else {
      this.other[name] = value;
    }
    this.#link.write();
    this.show();
  }

  /** Asks what a boat observes, where no time passes. */
  async #look(boat) {
    await this.attempt(async () => {
      const { taken } = await this.simulator.ask("look", { boat });
      if (boat === this.view.pinned) {
        this.view.observed = taken[0].observation;
        this.show();
      }
    });
  }
}
