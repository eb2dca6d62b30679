// The page's view: pictures, the means under them, charts, the map, and a leader's observation.

import { Chart, legendOf } from "../flockenv/replay/shared/chart.mjs";
import { Panel, parameterTable, runSwitch } from "../flockenv/replay/shared/panel.mjs";
import { colors, giveColors } from "../flockenv/replay/shared/scene.mjs";
import { byId, element, fixed } from "../flockenv/replay/shared/words.mjs";
import { chosenBoat, clockwise, doing, scoreWords } from "./doing.mjs";
import { ROUND_SECONDS, scoreOf } from "./game.mjs";
import { drawLapFrame } from "./lap_frame.mjs";
import { storyOf, wordsOf } from "./lessons.mjs";
import { OrderMap } from "./order_map.mjs";
import { MEANINGS } from "./quantities.mjs";
import { readLink } from "./request.mjs";

const CHARTS = ["psi_o", "rotation", "signed_order"];
/** Seconds of the charts before and after the present. */
const REACH = 60;
/** How long trails are, in s, and in all boats together: they take most of the time in which many boats are drawn. */
const [TRAIL_SECONDS, TRAIL_BOAT_SECONDS] = [10, 270];
/** Time in ms between two updates of words and numbers, which nobody reads faster. */
const WORDS_EVERY = 250;
/** Time in ms between two sentences for those who do not see the flocks. */
const ANNOUNCE_EVERY = 5000;
/** Force, in cm/s², that a bar half as long as a hull is wide stands for. */
const FORCE = 20;

export class View {
  panels = [];
  palette = colors();
  /** The boat whose numbers stay, and the one under the pointer. */
  pinned = null;
  hovered = null;
  /** The pinned leader's observation. */
  observed = null;
  /** Words about the rounds of a game. */
  rounds = "";
  #flocks;
  #quantities;
  #entries;
  #charts;
  /** Elements for means: under each picture, and of a game under all of them. */
  #scores = [];
  #worded = -Infinity;
  #told = -Infinity;

  /** `orders`: expected curves of the map; `seek`: goes to a time. */
  constructor(flocks, { quantities, entries }, orders, seek) {
    this.#flocks = flocks;
    this.#quantities = quantities;
    this.#entries = entries;
    this.#charts = CHARTS.map((key) => [new Chart(byId(key), flocks.runs, REACH, seek), key]);
    this.map = new OrderMap(byId("map"), orders);
  }

  /** Shows what a link says besides flocks. */
  choose({ speed, forces, colors: shown = "direction", boat, lesson = "" }) {
    byId("speed").value = speed;
    byId("forces").checked = forces === "1";
    byId("colors").value = shown;
    this.pinned = boat === undefined ? null : Number(boat);
    this.tell(lesson);
  }

  /** The sentences of a lesson, before and after the picture. */
  tell(name) {
    const { before, after } = wordsOf(name);
    if (byId("story").dataset.lesson !== name) {
      byId("story").dataset.lesson = name;
      byId("story").replaceChildren(...storyOf(before));
      byId("after").replaceChildren(...storyOf(after));
      byId("observes").open = name === "forces";
      // Until the lesson's flock has started, nothing is said about the previous flock.
      byId("doing").textContent = "";
    }
    const lessons = byId("lessons");
    for (const link of lessons.querySelectorAll("a")) {
      const isShown = link.dataset.lesson === name;
      link.setAttribute("aria-current", String(isShown));
      if (isShown) {
        // On a phone they are a row that scrolls.
        lessons.scrollLeft = link.offsetLeft - (lessons.clientWidth - link.clientWidth) / 2;
      }
    }
  }

  /** Replaces the pictures by those of other runs. `pin` pins or unpins a boat's numbers. */
  rebuild(pin, redraw) {
    const { runs, seen, besides, areYours, isRecorded, shown } = this.#flocks;
    const isPair = seen.length === 2 && besides === 1;
    document.body.classList.toggle("you", areYours);
    document.body.classList.toggle("trains", this.#flocks.areTrained);
    document.body.classList.toggle("pair", isPair);
    document.body.classList.toggle("many", seen.length > 1 && !isPair);
    document.body.classList.toggle("recorded", isRecorded);
    giveColors(runs);
    this.panels = seen.map((run, index) => new Panel(run, index, isPair));
    this.hurry();
    for (const panel of this.panels) {
      panel.onBoat((boat) => { this.hovered = boat; redraw(); }, (boat) => pin(boat === this.pinned ? null : boat));
    }
    this.#scores = isPair || !areYours ? this.panels.map(({ root }) => root.appendChild(element("p", "so-far"))) : [element("p", "so-far")];
    byId("runs").replaceChildren(...(isPair ? [runSwitch(runs, redraw)] : []), ...this.panels.map(({ root }) => root),
      ...(areYours ? this.#scores : []));
    for (const [chart] of this.#charts) {
      chart.runs = [runs[0], ...runs.slice(besides, besides + 1)];
    }
    byId("signed").hidden = runs.every(({ target }) => target === null);
    this.map.expect(isRecorded ? null : shown.flock, this.#flocks.signature);
    const kept = (boat, leaders) => new Option(boat < leaders ? `${boat}, leader` : boat, boat);
    byId("boat").replaceChildren(new Option("none", ""), ...Array.from({ length: runs[0].boats }, (_, k) => kept(k, runs[0].leaders)));
    byId("parameters").replaceChildren(parameterTable(runs));
    for (const link of byId("story").querySelectorAll("a")) {
      const { flock } = readLink(link.hash, Object.keys(this.#flocks.kinds));
      link.setAttribute("aria-current", String(Object.entries(flock).every(([name, value]) => shown.flock[name] === value)));
    }
  }

  /** Lets the next picture update the words, written and spoken. */
  hurry() {
    this.#worded = this.#told = -Infinity;
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
      this.#showWords(time, rate, isPlaying);
    }
  }

  #quantity(key) {
    return this.#quantities.find((quantity) => quantity.key === key);
  }

  #showWords(time, rate, isPlaying) {
    const { runs } = this.#flocks;
    // While a flock plays, the time above its picture runs ahead of words that are written more rarely.
    byId("clock").textContent = rate || `${fixed(time, 1)} s`;
    Object.assign(byId("scrub"), { min: runs[0].time[0], max: runs[0].end, value: time });
    byId("scrub").setAttribute("aria-valuetext", `${fixed(time, 1)} s`);
    for (const [chart, key] of this.#charts) {
      byId(key).previousElementSibling.replaceChildren(...legendOf(chart.runs, this.#quantity(key), time));
    }
    this.#scores.forEach((score, index) => { score.replaceChildren(...this.#score(index, time)); });
    this.#announceFlocks(time, isPlaying);
    this.#showStatistics();
    this.#showObserved();
  }

  /** Shows the mean so far in large type. A pair of pictures has both means below it, of which a wide window shows one under each picture; a game shows both. */
  #score(index, time) {
    const { areYours, besides, runs, seen } = this.#flocks;
    const line = (words, value, className = "") => {
      const part = element("span", className);
      part.append(element("span", "faint", words), element("b", "", value));
      return part;
    };
    const signed = (value) => fixed(value, 2, true);
    if (areYours) {
      const [yours, law] = [runs.slice(0, besides), runs.slice(besides)].map((side) => signed(scoreOf(side)));
      const isGame = byId("story").dataset.lesson === "steer";
      const moment = `${fixed(Math.min(time, ROUND_SECONDS), 0)} of ${ROUND_SECONDS} s${this.rounds && `. ${this.rounds}`}`;
      return [line("you ", yours), line("the law ", law), element("small", "faint", isGame ? moment : "")];
    }
    const key = (run) => wordsOf(byId("story").dataset.lesson).headline ?? (run.target === null ? "psi_o" : "signed_order");
    const mean = (run) => fixed(run.isRecorded ? run.meanUpTo(key(run), run.sampleAt(time)) : run.mean(key(run)), 2, key(run) !== "psi_o");
    const words = (run) => `mean ${this.#quantity(key(run)).words.split(",")[0]} so far `;
    const meaning = element("small", "faint", MEANINGS[key(seen[index])]);
    if (!document.body.classList.contains("pair")) {
      return [line(words(seen[index]), mean(seen[index])), meaning];
    }
    return [line(words(seen[index]), mean(seen[index]), "own"), ...seen.map((run) => line(`${run.name} `, mean(run), "each")), meaning];
  }

  /** Says what the flocks do to those who do not see it: in the pictures' names, and in a sentence that is read now and then. */
  #announceFlocks(time, isPlaying) {
    const { areYours } = this.#flocks;
    const told = this.panels.map(({ canvas, run }) => {
      const words = doing(run, run.sampleAt(time), this.palette);
      canvas.setAttribute("aria-label", words);
      return this.panels.length > 1 ? `${run.name}: ${words}` : words;
    });
    const chosen = this.pinned === null ? [] : [chosenBoat(this.panels[0].run, time, this.pinned, this.palette)];
    // No more than is spoken before the next sentence.
    const game = () => [clockwise(this.panels.map(({ run }) => run), time, this.palette), ...this.#scores.map((score) => scoreWords(score, this.rounds))];
    const said = [...chosen, ...(areYours ? game() : told)].join(" ");
    const isDue = !isPlaying || performance.now() - this.#told > ANNOUNCE_EVERY;
    if (isDue && said !== byId("doing").textContent) {
      this.#told = performance.now();
      byId("doing").textContent = said;
    }
  }

  /** Statistics of each run's substeps so far. */
  #showStatistics() {
    const { runs, statistics } = this.#flocks;
    const rows = byId("about-flock").open ? statistics : [];
    byId("statistics").replaceChildren(...rows.map(({ name }, index) => {
      const row = element("tr");
      const words = ({ statistics: numbers }) => (Number.isFinite(numbers[index]) ? String(Number(numbers[index].toPrecision(3))) : "unknown");
      row.append(element("th", "", name), ...runs.map((run) => element("td", "", words(run))));
      return row;
    }));
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
    table.setAttribute("aria-label", "Observation");
    this.#entries.forEach(({ block, place: count, name, meaning }, index) => {
      const row = element("tr");
      row.append(element("th", "", block === "neighbors" ? `neighbor ${count + 1}: ${name}` : name),
        element("td", "", fixed(this.observed[index], 2, true)), element("td", "faint", meaning));
      table.append(row);
    });
    byId("observation").replaceChildren(table);
  }
}
