// The page's view: pictures, the means under them, charts, the map, and a leader's observation.

import { Chart, legendOf } from "../flockenv/replay/shared/chart.mjs";
import { Panel, parameterTable, runSwitch } from "../flockenv/replay/shared/panel.mjs";
import { colors, giveColors } from "../flockenv/replay/shared/scene.mjs";
import { byId, element, fixed, withSign } from "../flockenv/replay/shared/words.mjs";
import { boatWords, clockwiseWords, flockWords, scoreWords } from "./doing.mjs";
import { ROUND_SECONDS, scoreOf } from "./game.mjs";
import { drawLapFrame } from "./lap_frame.mjs";
import { storyOf, wordsOf } from "./lessons.mjs";
import { OrderMap } from "./order_map.mjs";
import { MEANINGS } from "./quantities.mjs";
import { readLink } from "./request.mjs";

const CHARTS = ["psi_o", "rotation", "signed_order"];
/** Time in s that charts show before and after the present. */
const REACH = 60;
/** Length of trails in s, and the largest sum over all boats: trails take most of the time of drawing many boats. */
const [TRAIL_SECONDS, TRAIL_BOAT_SECONDS] = [10, 270];
/** Time in ms between two updates of words and numbers. */
const WORDS_EVERY = 250;
/** Time in ms between two sentences for screen readers. */
const ANNOUNCE_EVERY = 5000;
/** Force, in cm/s², whose bar is half as long as a hull is wide. */
const FORCE = 20;

export class View {
  panels = [];
  palette = colors();
  /** The boat whose numbers stay, and the boat under the pointer; null for none. */
  pinned = null;
  hovered = null;
  /** The pinned leader's observation. */
  observed = null;
  /** Words about the rounds of a game. */
  roundWords = "";
  #flocks;
  #quantities;
  #entries;
  #charts;
  /** Elements for means: under each picture, and of a game under all of them. */
  #scores = [];
  /** Times in ms of the latest words and of the latest sentence for screen readers. */
  #wordsAt = -Infinity;
  #announcedAt = -Infinity;

  /** `orders`: expected curves of the map; `seek`: goes to a time. */
  constructor(flocks, { quantities, entries }, orders, seek) {
    this.#flocks = flocks;
    this.#quantities = quantities;
    this.#entries = entries;
    this.#charts = CHARTS.map((key) => [new Chart(byId(key), flocks.runs, REACH, seek), key]);
    this.map = new OrderMap(byId("map"), orders);
  }

  /** Applies the parts of a link besides the flocks. */
  choose({ speed, forces, colors: coloring = "direction", boat, lesson = "" }) {
    byId("speed").value = speed;
    byId("forces").checked = forces === "1";
    byId("colors").value = coloring;
    this.pinned = boat === undefined ? null : Number(boat);
    this.showLesson(lesson);
  }

  /** Shows the sentences of a lesson, before and after the picture. */
  showLesson(name) {
    const { before, after } = wordsOf(name);
    if (byId("story").dataset.lesson !== name) {
      byId("story").dataset.lesson = name;
      byId("story").replaceChildren(...storyOf(before));
      byId("after").replaceChildren(...storyOf(after));
      byId("observes").open = name === "forces";
      byId("doing").textContent = ""; // It described the previous flock.
    }
    const lessons = byId("lessons");
    for (const link of lessons.querySelectorAll("a")) {
      const isShown = link.dataset.lesson === name;
      link.setAttribute("aria-current", String(isShown));
      if (isShown) {
        // On a phone the lessons are a row that scrolls.
        lessons.scrollLeft = link.offsetLeft - (lessons.clientWidth - link.clientWidth) / 2;
      }
    }
  }

  /** Replaces the pictures by those of other runs. `pin` pins or unpins a boat's numbers. */
  rebuild(pin, redraw) {
    const { runs, drawnRuns, firstBeside, areYours, isRecorded, shown } = this.#flocks;
    const isPair = drawnRuns.length === 2 && firstBeside === 1;
    document.body.classList.toggle("you", areYours);
    document.body.classList.toggle("trains", this.#flocks.areTrained);
    document.body.classList.toggle("pair", isPair);
    document.body.classList.toggle("many", drawnRuns.length > 1 && !isPair);
    document.body.classList.toggle("recorded", isRecorded);
    giveColors(runs);
    this.panels = drawnRuns.map((run, index) => new Panel(run, index, isPair));
    this.showWordsNow();
    for (const panel of this.panels) {
      panel.onBoat((boat) => { this.hovered = boat; redraw(); }, (boat) => pin(boat === this.pinned ? null : boat));
    }
    this.#scores = isPair || !areYours ? this.panels.map(({ root }) => root.appendChild(element("p", "so-far"))) : [element("p", "so-far")];
    byId("runs").replaceChildren(...(isPair ? [runSwitch(runs, redraw)] : []), ...this.panels.map(({ root }) => root),
      ...(areYours ? this.#scores : []));
    for (const [chart] of this.#charts) {
      chart.runs = [runs[0], ...runs.slice(firstBeside, firstBeside + 1)];
    }
    byId("signed").hidden = runs.every(({ target }) => target === null);
    this.map.expect(isRecorded ? null : shown.flock, this.#flocks.signature);
    const optionOf = (boat) => new Option(boat < runs[0].leaders ? `${boat}, leader` : boat, boat);
    byId("boat").replaceChildren(new Option("none", ""), ...Array.from({ length: runs[0].boats }, (_, boat) => optionOf(boat)));
    byId("parameters").replaceChildren(parameterTable(runs));
    for (const link of byId("story").querySelectorAll("a")) {
      const { flock } = readLink(link.hash, Object.keys(this.#flocks.kinds));
      link.setAttribute("aria-current", String(Object.entries(flock).every(([name, value]) => shown.flock[name] === value)));
    }
  }

  /** Updates the words, written and spoken, with the next picture. */
  showWordsNow() {
    this.#wordsAt = this.#announcedAt = -Infinity;
  }

  /** Draws the flocks at a time in s; while they play, updates words and numbers at intervals. `now`: time in ms; `rate`: the speed in words. */
  show(time, { now = performance.now(), isPlaying = false, rate = "" } = {}) {
    const { runs, areYours } = this.#flocks;
    const trailSeconds = Math.min(TRAIL_SECONDS, TRAIL_BOAT_SECONDS / runs[0].boats);
    const coloring = byId("colors").value;
    document.body.dataset.colors = coloring;
    const options = { trailSeconds, coloring, forceScale: byId("forces").checked ? FORCE : null, boat: this.hovered ?? this.pinned, palette: this.palette };
    for (const panel of this.panels) {
      panel.show(time, options);
      if (this.pinned !== null && this.pinned < panel.run.boats && !areYours && panel.canvas.clientWidth > 0) {
        drawLapFrame(panel.scene, this.pinned);
      }
    }
    for (const [chart, key] of this.#charts) {
      chart.draw(time, this.#quantity(key), this.palette);
    }
    this.map.draw(this.palette);
    if (!isPlaying || now - this.#wordsAt >= WORDS_EVERY) {
      this.#wordsAt = now;
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
    const { areYours, firstBeside, runs, drawnRuns } = this.#flocks;
    const line = (words, value, className = "") => {
      const part = element("span", className);
      part.append(element("span", "faint", words), element("b", "", value));
      return part;
    };
    if (areYours) {
      const [yours, law] = [runs.slice(0, firstBeside), runs.slice(firstBeside)].map((side) => withSign(scoreOf(side), 2));
      const isGame = byId("story").dataset.lesson === "steer";
      const moment = `${fixed(Math.min(time, ROUND_SECONDS), 0)} of ${ROUND_SECONDS} s${this.roundWords && `. ${this.roundWords}`}`;
      return [line("you ", yours), line("the law ", law), element("small", "faint", isGame ? moment : "")];
    }
    const key = (run) => wordsOf(byId("story").dataset.lesson).headline ?? (run.target === null ? "psi_o" : "signed_order");
    const meanOf = (run) => (run.isRecorded ? run.meanUpTo(key(run), run.sampleAt(time)) : run.mean(key(run)));
    const mean = (run) => (key(run) === "psi_o" ? fixed(meanOf(run), 2) : withSign(meanOf(run), 2));
    const words = (run) => `mean ${this.#quantity(key(run)).words.split(",")[0]} so far `;
    const meaning = element("small", "faint", MEANINGS[key(drawnRuns[index])]);
    if (!document.body.classList.contains("pair")) {
      return [line(words(drawnRuns[index]), mean(drawnRuns[index])), meaning];
    }
    return [line(words(drawnRuns[index]), mean(drawnRuns[index]), "own"), ...drawnRuns.map((run) => line(`${run.name} `, mean(run), "each")), meaning];
  }

  /** Says what the flocks do to those who do not see it: in the pictures' names, and in a sentence that is read now and then. */
  #announceFlocks(time, isPlaying) {
    const { areYours } = this.#flocks;
    const sentences = this.panels.map(({ canvas, run }) => {
      const words = flockWords(run, run.sampleAt(time), this.palette);
      canvas.setAttribute("aria-label", words);
      return this.panels.length > 1 ? `${run.name}: ${words}` : words;
    });
    const hasChosen = this.pinned !== null && this.pinned < this.panels[0].run.boats;
    const chosen = hasChosen ? [boatWords(this.panels[0].run, time, this.pinned, this.palette)] : [];
    // Only as much as a screen reader speaks before the next sentence.
    const game = () => [clockwiseWords(this.panels.map(({ run }) => run), time, this.palette), ...this.#scores.map((score) => scoreWords(score, this.roundWords))];
    const text = [...chosen, ...(areYours ? game() : sentences)].join(" ");
    if ((!isPlaying || performance.now() - this.#announcedAt > ANNOUNCE_EVERY) && text !== byId("doing").textContent) {
      this.#announcedAt = performance.now();
      byId("doing").textContent = text;
    }
  }

  /** Shows the statistics of each run's substeps so far. */
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

  /** Shows the numbers that the pinned leader observes. */
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
    this.#entries.forEach(({ block, place: number, name, meaning }, index) => {
      const row = element("tr");
      row.append(element("th", "", block === "neighbors" ? `neighbor ${number + 1}: ${name}` : name),
        element("td", "", withSign(this.observed[index], 2)), element("td", "faint", meaning));
      table.append(row);
    });
    byId("observation").replaceChildren(table);
  }
}
