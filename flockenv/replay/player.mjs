// The page: playing, scrubbing, keys, the link, and drawing.

import { Chart, legendOf } from "./shared/chart.mjs";
import { forceScale } from "./shared/forces.mjs";
import { linkTo, readLink } from "./link.mjs";
import { LinkWriter } from "./shared/link.mjs";
import { colorKey, Panel, parameterTable, runSwitch } from "./shared/panel.mjs";
import { span } from "./shared/run.mjs";
import { colors, giveColors } from "./shared/scene.mjs";
import { Transport } from "./shared/transport.mjs";
import { caption, fixed } from "./shared/words.mjs";

export const SPEEDS = [0.25, 0.5, 1, 2, 4, 8, 16, 32, 64];
const FIRST_SPEED = 8;
/** Longer steps of the keys, in s. */
const [LONG_STEP, MINUTE] = [10, 60];

/** A sentence on the quantity to watch in these runs, and what its values mean. */
function watchWords(runs) {
  const rotation = "rotation is 1 if all circle clockwise, and −1 if all circle counter-clockwise";
  if (runs.some(({ target }) => target !== null)) {
    return "Watch whether the boats come to circle with the leaders, which have a ring: the signed order is 1 if all do, and " +
      "−1 if all circle the other way.";
  }
  return `Watch ${runs.some(({ leaders }) => leaders > 0) ? "which leaders the boats follow" : "whether the boats come to circle together"}: ${rotation}.`;
}

export class Player {
  time = 0;
  pinned = null;
  hovered = null;
  palette = colors();
  /** The animation frame that will draw the page; undefined if none is requested. */
  frame = undefined;
  #transport = new Transport(document.getElementById("play"), (passed) => this.#tick(passed));
  #link = new LinkWriter(() => linkTo(this.time, this.speed));

  /** `moment` in s is where the page opens unless its link says otherwise. */
  constructor(runs, quantities, moment) {
    this.runs = runs;
    this.quantities = quantities;
    this.controls = Object.fromEntries(
      ["play", "back", "forward", "scrub", "clock", "speed", "trails", "boat", "colors", "forces", "quantity", "legend",
        "help", "keys", "letters", "status"]
        .map((id) => [id, document.getElementById(id)]),
    );
    [this.start, this.end] = span(runs);
    this.time = this.start;
    this.forceScale = forceScale(runs);
    giveColors(runs);
    this.panels = runs.map((run, index) => new Panel(run, index, runs.length > 1));
    document.body.classList.toggle("pair", runs.length > 1);
    document.getElementById("watch").textContent = watchWords(runs);
    const several = runs.length > 1 ? [runSwitch(runs, () => this.request())] : [];
    document.getElementById("runs").append(...several, ...this.panels.map((panel) => panel.root));
    const seek = (time) => this.seek(time);
    this.charts = [
      new Chart(document.getElementById("detail"), runs, 30, seek),
      new Chart(document.getElementById("overview"), runs, null, seek),
    ];
    this.#fill();
    this.#listen();
    this.seek(moment);
    this.#followLink();
    this.show();
  }

  get playing() {
    return this.#transport.playing;
  }

  get speed() {
    return Number(this.controls.speed.value);
  }

  /** The boat whose numbers are shown: the one under the pointer, or else the pinned one. */
  get boat() {
    return this.hovered ?? this.pinned;
  }

  /** Fills the choices, the key of colors and the table of parameters. */
  #fill() {
    const { speed, quantity, scrub, forces, boat } = this.controls;
    speed.append(...SPEEDS.map((factor) => new Option(`${factor} ×`, factor)));
    speed.value = FIRST_SPEED;
    quantity.append(...this.quantities.map((series) => new Option(caption(series), series.key)));
    [scrub.min, scrub.max, scrub.value] = [this.start, this.end, this.start];
    boat.append(new Option("none", ""));
    for (let k = 0; k < this.#mostBoats(); k += 1) {
      boat.append(new Option(this.runs.some((run) => k < run.leaders) ? `${k}, leader` : k, k));
    }
    if (!this.runs.some((run) => run.hasForces)) {
      forces.checked = false;
      forces.disabled = true;
      const label = document.getElementById("forces-label");
      label.append(" (not recorded)");
      label.title = "Runs recorded with contacts=True show them";
    }
    document.getElementById("color-key").append(...colorKey());
    document.getElementById("parameters").append(parameterTable(this.runs));
  }

  #mostBoats() {
    return Math.max(...this.runs.map((run) => run.boats));
  }

  #listen() {
    const { play, back, forward, scrub, speed, trails, boat, colors: coloring, forces, quantity, help, keys } = this.controls;
    play.addEventListener("click", () => this.toggle());
    back.addEventListener("click", () => this.step(-1));
    forward.addEventListener("click", () => this.step(1));
    scrub.addEventListener("input", () => this.seek(Number(scrub.value)));
    help.addEventListener("click", () => keys.showModal());
    for (const control of [trails, coloring, forces, quantity]) {
      control.addEventListener("change", () => this.show());
    }
    speed.addEventListener("change", () => { this.#link.write(); this.show(); });
    boat.addEventListener("change", () => this.pin(boat.value === "" ? null : Number(boat.value)));
    for (const panel of this.panels) {
      panel.onBoat((boat) => this.hover(boat), (boat) => this.pin(boat === this.pinned ? null : boat));
    }
    document.addEventListener("keydown", (event) => this.#key(event));
    window.addEventListener("hashchange", () => this.#followLink());
    new ResizeObserver(() => this.show()).observe(document.getElementById("runs"));
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
      this.palette = colors();
      this.show();
    });
  }

  #key(event) {
    const { keys, letters, forces } = this.controls;
    if (keys.open || event.ctrlKey || event.metaKey || event.altKey || event.target.closest("select, summary")) {
      return;
    }
    if (event.key === " " && event.target.closest("button, input[type=checkbox]")) {
      return;
    }
    const namedKeys = {
      " ": () => this.toggle(),
      ArrowLeft: () => (event.shiftKey ? this.seek(this.time - LONG_STEP) : this.step(-1)),
      ArrowRight: () => (event.shiftKey ? this.seek(this.time + LONG_STEP) : this.step(1)),
      PageUp: () => this.seek(this.time + MINUTE),
      PageDown: () => this.seek(this.time - MINUTE),
      Home: () => this.seek(this.start),
      End: () => this.seek(this.end),
      Escape: () => this.pin(null),
    };
    const letterKeys = {
      "+": () => this.#choose("speed", 1),
      "-": () => this.#choose("speed", -1),
      t: () => this.#choose("trails", 1, { wraps: true }),
      c: () => this.#choose("colors", 1, { wraps: true }),
      f: () => forces.click(),
      "]": () => this.#pinNext(1),
      "[": () => this.#pinNext(-1),
      "?": () => keys.showModal(),
    };
    const action = namedKeys[event.key] ?? (letters.checked ? letterKeys[event.key.toLowerCase()] : undefined);
    if (action) {
      event.preventDefault();
      action();
    }
  }

  /** Moves a select by some options. With `wraps` the first option follows the last. */
  #choose(name, by, { wraps = false } = {}) {
    const select = this.controls[name];
    const count = select.options.length;
    const next = select.selectedIndex + by;
    select.selectedIndex = wraps ? next % count : Math.min(Math.max(next, 0), count - 1);
    select.dispatchEvent(new Event("change"));
  }

  #pinNext(by) {
    const boats = this.#mostBoats();
    const first = by > 0 ? 0 : boats - 1;
    this.pin(this.pinned === null ? first : (this.pinned + by + boats) % boats);
  }

  /** Pins the card of a boat; null unpins it. */
  pin(boat) {
    this.pinned = boat;
    this.controls.boat.value = boat ?? "";
    this.show();
  }

  /** Shows the card of the boat under the pointer; null for none. */
  hover(boat) {
    if (boat !== this.hovered) {
      this.hovered = boat;
      this.request();
    }
  }

  /** Pauses at the sample just shown, or plays; at the end, from the start. */
  toggle() {
    if (this.playing) {
      this.#transport.pause();
      this.time = this.#sampleTime(this.time);
      this.#link.write();
    } else {
      if (this.time >= this.end) {
        this.time = this.start;
      }
      this.#transport.play();
    }
    this.show();
  }

  /** The time of the last sample of any run up to this time. */
  #sampleTime(time) {
    const times = this.runs.map((run) => run.time[run.sampleAt(time)]);
    return Math.max(this.start, ...times.filter((sampled) => sampled <= time + 1e-9));
  }

  /** Pauses, and goes to the next sample of any run (`by` is 1) or to the previous one (−1). */
  step(by) {
    this.#transport.pause();
    const nextTime = Math.min(this.end, ...this.runs.map((run) => run.timeAfter(this.time)));
    this.seek(by < 0 ? this.time - 1e-6 : nextTime);
  }

  /** Goes to the last sample up to a time, so that the numbers belong to the poses that are drawn. */
  seek(time) {
    this.time = this.#sampleTime(Math.min(Math.max(time, this.start), this.end));
    this.#transport.restartClock();
    this.#link.write();
    this.request();
  }

  /** Draws the page at the next animation frame; further requests before it add nothing. */
  request() {
    this.frame ??= requestAnimationFrame(() => this.show());
  }

  #tick(passed) {
    this.time = Math.min(this.time + passed * this.speed, this.end);
    if (this.time >= this.end) {
      this.#transport.pause();
    }
    this.#link.write();
    this.show();
  }

  /** Follows the page's link, and reports the parts that it cannot follow. */
  #followLink() {
    const requested = readLink(location.hash, { start: this.start, end: this.end, speeds: SPEEDS });
    this.controls.status.textContent = requested.ignored.join(" ");
    if (requested.speed !== null) {
      this.controls.speed.value = requested.speed;
    }
    if (requested.time !== null) {
      this.seek(requested.time);
    }
  }

  show() {
    cancelAnimationFrame(this.frame);
    this.frame = undefined;
    const { scrub, clock, trails, forces, quantity } = this.controls;
    document.body.dataset.colors = this.controls.colors.value;
    const options = {
      trailSeconds: Number(trails.value),
      forceScale: forces.checked ? this.forceScale : null,
      boat: this.boat,
      coloring: this.controls.colors.value,
      palette: this.palette,
    };
    for (const panel of this.panels) {
      panel.show(this.time, options);
    }
    const chosen = this.quantities.find(({ key }) => key === quantity.value);
    for (const chart of this.charts) {
      chart.draw(this.time, chosen, this.palette);
    }
    scrub.value = this.time;
    scrub.style.setProperty("--done", `${(100 * (this.time - this.start)) / (this.end - this.start || 1)}%`);
    clock.textContent = `${fixed(this.#sampleTime(this.time), 1)} s of ${fixed(this.end, 1)} s`;
    scrub.setAttribute("aria-valuetext", clock.textContent);
    this.controls.legend.replaceChildren(...legendOf(this.runs, chosen, this.time, { hasMeans: true }));
  }
}
