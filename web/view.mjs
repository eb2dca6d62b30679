// What is seen: pictures, the means under them, charts, the map, and what a leader observes.

import { Chart, legendOf } from "../flockenv/replay/shared/chart.mjs";
import { Panel, parameterTable, runSwitch } from "../flockenv/replay/shared/panel.mjs";
import { colors } from "../flockenv/replay/shared/scene.mjs";
import { byId, element, fixed } from "../flockenv/replay/shared/words.mjs";
import { drawLapFrame } from "./lap_frame.mjs";
import { storyOf, wordsOf } from "./lessons.mjs";
import { OrderMap } from "./order_map.mjs";

const CHARTS = ["psi_o", "rotation", "signed_order"];
/** Seconds of the charts before and after the present. */
const REACH = 60;
/** How long trails are, in s, and in all boats together: they take most of the time in which many boats are drawn. */
const [TRAIL_SECONDS, TRAIL_BOAT_SECONDS] = [10, 270];
/** How often, in ms, words and numbers that nobody reads faster are written. */
const WORDS_EVERY = 250;
/** Force, in cm/s², that a bar as long as a hull is wide stands for. */
const FORCE = 20;

export class View {
  panels = [];
  palette = colors();
  /** The boat whose numbers stay, and the one under the pointer. */
  pinned = null;
  hovered = null;
  /** What the pinned leader observes. */
  observed = null;
  #flocks;
  #quantities;
  #entries;
  #charts;
  #worded = -Infinity;

  /** `orders`: expected curves of the map; `seek`: goes to a time. */
  constructor(flocks, { quantities, entries }, orders, seek) {
    this.#flocks = flocks;
    this.#quantities = quantities;
    this.#entries = entries;
    this.#charts = CHARTS.map((key) => [new Chart(byId(key), flocks.runs, REACH, seek), key]);
    this.map = new OrderMap(byId("map"), orders);
  }

  /** The sentences of a lesson, before and after the picture. */
  tell(name) {
    const { before, after } = wordsOf(name);
    if (byId("story").dataset.lesson !== name) {
      byId("story").dataset.lesson = name;
      byId("story").replaceChildren(...storyOf(before));
      byId("after").replaceChildren(...storyOf(after));
      byId("observes").open = name === "forces";
    }
    for (const link of byId("lessons").querySelectorAll("a")) {
      link.setAttribute("aria-current", String(link.dataset.lesson === name));
    }
  }

  /** Pictures of other runs. `pin`: keeps a boat's numbers, or lets them go. */
  rebuild(pin, redraw) {
    const { runs, areYours, isRecorded, shown } = this.#flocks;
    const isPair = runs.length > 1;
    document.body.classList.toggle("you", areYours);
    document.body.classList.toggle("pair", isPair && !areYours);
    document.body.classList.toggle("recorded", isRecorded);
    this.panels = runs.map((run, place) => new Panel(run, place, isPair));
    for (const panel of this.panels) {
      panel.onBoat((boat) => { this.hovered = boat; redraw(); }, (boat) => pin(boat === this.pinned ? null : boat));
      panel.root.append(element("p", "so-far"));
    }
    byId("runs").replaceChildren(...(isPair ? [runSwitch(runs, redraw)] : []), ...this.panels.map(({ root }) => root));
    for (const [chart] of this.#charts) {
      chart.runs = runs;
    }
    byId("signed").hidden = runs.every(({ target }) => target === null);
    this.map.expect(isRecorded ? null : shown.flock, this.#flocks.signature);
    const kept = (boat, leaders) => new Option(boat < leaders ? `${boat}, leader` : boat, boat);
    byId("boat").replaceChildren(new Option("none", ""), ...Array.from({ length: runs[0].boats }, (_, k) => kept(k, runs[0].leaders)));
    byId("parameters").replaceChildren(parameterTable(runs));
  }

  /** Draws the flocks at a time, and now and then writes what else is said of them. */
  show(time, { now = performance.now(), isPlaying = false, rate = "" } = {}) {
    const { runs, areYours } = this.#flocks;
    const trailSeconds = Math.min(TRAIL_SECONDS, TRAIL_BOAT_SECONDS / runs[0].boats);
    const coloring = byId("colors").value;
    document.body.dataset.colors = coloring;
    const options = { trailSeconds, coloring, forceScale: byId("forces").checked ? FORCE : null, boat: this.hovered ?? this.pinned, palette: this.palette };
    for (const panel of this.panels) {
      panel.show(time, options);
      if (this.pinned !== null && !areYours && panel.canvas.clientWidth > 0) {
        drawLapFrame(panel.scene, this.pinned);
      }
    }
    for (const [chart, key] of this.#charts) {
      chart.draw(time, this.#quantity(key), this.palette);
    }
    this.map.draw(this.palette);
    if (!isPlaying || !(now - this.#worded < WORDS_EVERY)) {
      this.#worded = now;
      this.#showWords(time, rate);
    }
  }

  #quantity(key) {
    return this.#quantities.find((each) => each.key === key);
  }

  #showWords(time, rate) {
    const { runs } = this.#flocks;
    // While a flock plays, the time above its picture runs ahead of words that are written more rarely.
    byId("clock").textContent = rate || `${fixed(time, 1)} s`;
    Object.assign(byId("scrub"), { min: runs[0].time[0], max: runs[0].end, value: time });
    byId("scrub").setAttribute("aria-valuetext", `${fixed(time, 1)} s`);
    for (const [, key] of this.#charts) {
      byId(key).previousElementSibling.replaceChildren(...legendOf(runs, this.#quantity(key), time));
    }
    this.panels.forEach(({ root, run }, place) => {
      const yours = this.#flocks.areYours && place === 0 ? runs : [run];
      root.querySelector(".so-far").replaceChildren(...yours.flatMap((each, k) => this.#mean(each, k)));
    });
    this.#showObserved();
  }

  /** The mean so far, large; of a game both. */
  #mean(run, place) {
    const key = run.target === null ? "psi_o" : "signed_order";
    const words = this.#flocks.areYours ? ["you ", " · the law "][place] : `mean ${this.#quantity(key).words} so far `;
    return [element("span", "faint", words), element("b", "", fixed(run.mean(key), 2, key === "signed_order"))];
  }

  #showObserved() {
    const { runs, isRecorded } = this.#flocks;
    const isLeader = this.pinned !== null && this.pinned < runs[0].leaders && !isRecorded;
    byId("observes").hidden = !isLeader;
    if (!isLeader || !byId("observes").open || this.observed?.length !== this.#entries.length) {
      byId("observation").replaceChildren();
      return;
    }
    const table = element("table");
    this.#entries.forEach(({ block, place: count, name, meaning }, place) => {
      const row = element("tr");
      row.append(element("th", "", block === "neighbors" ? `neighbor ${count + 1}: ${name}` : name),
        element("td", "", fixed(this.observed[place], 2, true)), element("td", "faint", meaning));
      table.append(row);
    });
    byId("observation").replaceChildren(table);
  }
}
