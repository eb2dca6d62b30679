// The page: flocks that the simulator moves, their pictures and series, and everything that a visitor may do.

import { Chart, legendOf } from "../flockenv/replay/shared/chart.mjs";
import { Panel, parameterTable, runSwitch } from "../flockenv/replay/shared/panel.mjs";
import { colors } from "../flockenv/replay/shared/scene.mjs";
import { element, fixed } from "../flockenv/replay/shared/words.mjs";
import { Controls, LEADERS, opposedTargets, policiesOf } from "./controls.mjs";
import { byKind } from "./core.mjs";
import { GrowingRun } from "./growing_run.mjs";
import { drawLapFrame } from "./lap_frame.mjs";
import { OrderMap } from "./order_map.mjs";
import { commandLine, linkTo, pythonText, readLink, requestsOf, SPEEDS } from "./request.mjs";
import { LESSONS, storyOf } from "./lessons.mjs";
import { download, recordingOf, runOfFile } from "./share.mjs";

const CHARTS = ["psi_o", "rotation", "signed_order"];
/** Seconds of the charts before and after the present. */
const REACH = 60;
/** How long trails are, in s, and in all boats together: they take most of the time in which many boats are drawn. */
const [TRAIL_SECONDS, TRAIL_BOAT_SECONDS] = [10, 270];
/** How long the simulator may compute for one frame, in ms. */
const FRAME_WORK = 12;
/** How often, in ms, words and numbers that nobody reads faster are written. */
const WORDS_EVERY = 250;
const LINK_AFTER = 1000;
/** What the page opens with unless its link says otherwise. */
export const OPENING = LESSONS[0].link;
/** Force, in cm/s², that a bar as long as a hull is wide stands for. */
const FORCE = 20;
/** Seconds after the start that the map leaves out: boats start at random and at rest. */
const SETTLING = 30;
/** The number of no boat. */
const NO_BOAT = 1e6;
/** Fields whose change makes another flock of a map's. */
const NOT_ON_MAP = new Set(["bw_s", "seed", "target"]);

const byId = (id) => document.getElementById(id);

/** Two flocks are called by what distinguishes them. */
function distinguished(described) {
  const parts = described.map(({ name }) => name.split(", "));
  const place = parts.length > 1 && parts[0][0] === parts[1][0] ? 1 : 0;
  return parts.length === 1 ? described : described.map((each, k) => ({ ...each, name: parts[k][place] ?? each.name }));
}

export class LivePage {
  constructor(simulator, about, described) {
    const kinds = byKind(described);
    Object.assign(this, { simulator, about, runs: [], panels: [], time: 0, playing: false, pinned: null, hovered: null, rudder: 0 });
    this.kinds = Object.fromEntries(kinds.get("field").map(([name, kind]) => [name, kind]));
    this.quantities = kinds.get("quantity").map(([key, kind, label, symbol, unit, low, high]) => ({
      key, kind, unit, decimals: 2, words: label.replace(/^[^,]*/, (word) => `${word} ${symbol}`.trim()).replace("_o", "ₒ"),
      range: low === "NaN" ? null : [Number(low), Number(high)],
    }));
    this.phases = kinds.get("phase").map(([name]) => name);
    this.entries = kinds.get("entry");
    this.palette = colors();
    const meanings = Object.fromEntries(kinds.get("field").map(([name, , , accepted, doc]) => [name, `${doc} Accepted: ${accepted}`]));
    this.controls = new Controls(meanings, kinds.get("policy").map(([name]) => name), (name, value) => this.set(name, value));
    byId("speed").append(...SPEEDS.map((each) => new Option(each === "max" ? "as fast as it goes" : `${each} ×`, each)));
    this.charts = CHARTS.map((key) => [new Chart(byId(key), this.runs, REACH, (time) => this.seek(time)), key]);
    this.map = new OrderMap(byId("map"));
    this.#listen();
  }

  /** Shows what a link asks for. */
  async follow(fragment) {
    const linked = readLink(fragment, Object.keys(this.kinds));
    const words = [...linked.ignored];
    this.other = { speed: "8", ...linked.other };
    byId("speed").value = this.other.speed;
    byId("forces").checked = this.other.forces === "1";
    this.pinned = this.other.boat === undefined ? null : Number(this.other.boat);
    this.#showStory(this.other.lesson);
    const wanted = { flock: linked.flock, beside: linked.beside };
    // What the simulator refuses is left out, one parameter after another.
    for (let tries = 0; tries < 40; tries += 1) {
      try {
        await this.#become(wanted, "open", words);
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
    const base = this.wanted ?? this.asked;
    const wanted = { flock: { ...base.flock }, beside: base.beside && { ...base.beside } };
    if (name === "beside") {
      const [field, different] = value.split("=");
      wanted.beside = field ? { [field]: different } : null;
    } else if (name === "preset") {
      const { n_boats, n_leaders, seed, leaders } = { ...this.values, ...wanted.flock };
      wanted.flock = { preset: value, n_boats, n_leaders, ...(seed && { seed }), ...(leaders && { leaders }) };
    } else if (name === "leaders" && value === "each") {
      wanted.flock.leaders = policiesOf(base.flock.leaders ?? "", Number(this.values.n_leaders));
    } else if (name === "target") {
      wanted.flock.target = value === "opposed" ? opposedTargets(Number(this.values.n_leaders)) : value;
    } else {
      wanted.flock[name] = value;
    }
    const targets = wanted.flock.target ?? this.values.target;
    if (name === "n_leaders" && targets.includes(",")) {
      wanted.flock.target = Number(value) > 1 ? opposedTargets(Number(value)) : "cw";
    }
    if (name === "n_leaders" && wanted.flock.leaders?.includes(",")) {
      wanted.flock.leaders = policiesOf(wanted.flock.leaders, Number(value));
    }
    if (wanted.flock.leaders === "you" && !wanted.beside) {
      wanted.beside = { leaders: "paper's law at every substep" };
    }
    if (name === "leaders" && value !== "you" && base.flock.leaders === "you") {
      wanted.beside = null;
    }
    this.wanted = wanted;
    this.#change();
  }

  /** Starts again, with this seed. */
  async restart(seed = this.asked.flock.seed) {
    const flock = { ...this.asked.flock, ...(seed !== undefined && { seed }) };
    await this.#attempt(() => this.#become({ ...this.asked, flock }, "open", []));
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
      const alike = JSON.stringify(wanted.beside) === JSON.stringify(this.asked.beside);
      await this.#attempt(() => this.#become(wanted, alike && !this.recorded ? "change" : "open", []));
    }
    this.changing = false;
  }

  async #attempt(question) {
    try {
      await question();
    } catch (error) {
      if (error.refused) {
        this.say(`${error.message}.`);
        this.controls.show(this.#controlled());
      } else {
        this.#stop(error);
      }
    }
  }

  /** Has the simulator open or change the flocks, and shows them. */
  async #become(wanted, kind, words) {
    const had = this.shown;
    // What is changed meanwhile is changed of this.
    this.asked = wanted;
    const answer = this.simulator.ask(kind, { requests: requestsOf(wanted) });
    const { continues, values, taken } = await answer.catch((error) => {
      this.asked = this.shown;
      throw error;
    });
    const described = distinguished(values.map((text, place) => this.#describe(text, wanted, place)));
    const isSame = continues && described.every(({ boats }, place) => this.runs[place]?.boats === boats);
    const signature = JSON.stringify(Object.entries(described[0].parameters).filter(([name]) => !NOT_ON_MAP.has(name)));
    if (signature !== this.signature) {
      this.map.clear();
      this.signature = signature;
    }
    Object.assign(this, { shown: wanted, values: described[0].parameters, recorded: false });
    if (isSame) {
      this.runs.forEach((run, place) => { run.describe(described[place]); });
    } else {
      const names = this.quantities.map(({ key }) => key);
      this.runs = described.map((each) => new GrowingRun(each, names));
      this.time = 0;
    }
    taken.forEach((each, place) => { this.runs[place].append(each); });
    if (had && kind === "change") {
      words.push(isSame ? "The flock continues from where it is." : "The flock starts again: it cannot continue with this change.");
    }
    this.#showRuns();
    this.say(words.join(" "));
    this.#writeLink();
  }

  #describe(text, wanted, place) {
    const lines = byKind(text);
    const parameters = Object.fromEntries(lines.get("value"));
    const fields = place === 0 ? wanted.flock : { ...wanted.flock, ...wanted.beside };
    const leaders = Number(parameters.n_leaders);
    const policy = fields.leaders ?? "paper's law at every substep";
    const steering = policy.includes(",") ? "each its own" : LEADERS[policy] ?? policy;
    const name = leaders === 0 ? "no leaders" : `${leaders} leader${leaders > 1 ? "s" : ""}, ${steering}`;
    return this.#described(text, { name, seed: fields.seed ?? "0", version: this.about.version });
  }

  /** What runs and panels know of a flock, from the simulator's values. */
  #described(text, named) {
    const lines = byKind(text);
    const parameters = Object.fromEntries(lines.get("value"));
    const lengths = Object.fromEntries(lines.get("length").map(([name, value]) => [name, value === "inf" ? null : Number(value)]));
    const rows = (value) => value.split(";").filter(Boolean).map((row) => row.split(",").map(Number));
    const leaders = Number(parameters.n_leaders);
    const targets = parameters.target.split(",");
    const isCommon = leaders > 0 && new Set(targets).size === 1;
    return {
      ...named, parameters, lengths, leaders, boats: Number(parameters.n_boats), bw_s: Number(parameters.bw_s),
      target: isCommon ? targets[0] : null, targets: leaders > 0 && !isCommon ? targets : undefined,
      discs: rows(parameters.discs), walls: rows(parameters.walls), phases: this.phases, ids: null, every: 1,
    };
  }

  #showRuns() {
    document.body.classList.toggle("you", this.isYours);
    document.body.classList.toggle("pair", this.runs.length > 1 && !this.isYours);
    document.body.classList.toggle("recorded", this.recorded);
    const isPair = this.runs.length > 1;
    this.panels = this.runs.map((run, place) => new Panel(run, place, isPair));
    for (const panel of this.panels) {
      panel.onBoat((boat) => { this.hovered = boat; }, (boat) => this.pin(boat === this.pinned ? null : boat));
    }
    byId("runs").replaceChildren(...(isPair ? [runSwitch(this.runs, () => this.show())] : []), ...this.panels.map(({ root }) => root));
    byId("signed").hidden = this.runs.every(({ target }) => target === null);
    for (const [chart] of this.charts) {
      chart.runs = this.runs;
    }
    if (this.isYours) {
      this.pinned = 0;
    }
    const boats = byId("boat");
    boats.replaceChildren(new Option("none", ""), ...Array.from({ length: this.runs[0].boats }, (_, k) =>
      new Option(k < this.runs[0].leaders ? `${k}, leader` : k, k)));
    this.pin(this.pinned !== null && this.pinned < this.runs[0].boats ? this.pinned : null);
    this.controls.show(this.#controlled());
    byId("parameters").replaceChildren(parameterTable(this.runs));
    for (const link of byId("story").querySelectorAll("a")) {
      const { flock } = readLink(link.hash, Object.keys(this.kinds));
      link.setAttribute("aria-current", String(Object.entries(flock).every(([name, value]) => this.shown.flock[name] === value)));
    }
    this.#showTexts();
    this.show();
  }

  #controlled() {
    const { flock, beside } = this.shown;
    const target = this.values.target.includes(",") ? "opposed" : this.values.target;
    const differs = Object.entries(beside ?? {}).map(([name, value]) => `${name}=${value}`).join(" ");
    return { ...this.values, target, preset: flock.preset ?? "simulation", leaders: flock.leaders ?? "paper's law at every substep", beside: differs };
  }

  get isYours() {
    return !this.recorded && this.shown?.flock.leaders === "you";
  }

  say(words) {
    byId("status").textContent = words;
  }

  #stop(error) {
    this.playing = false;
    this.say(`The simulator stopped: ${error.message}. “Again” starts it again.`);
    this.broken = true;
    this.#showPlaying();
  }

  #showStory(name) {
    const lesson = LESSONS.find((each) => each.name === name);
    if (byId("story").dataset.lesson === name) {
      return;
    }
    byId("story").dataset.lesson = name ?? "";
    byId("observes").open = name === "forces";
    byId("story").replaceChildren(...(lesson ? storyOf(lesson) : []));
    for (const link of byId("lessons").querySelectorAll("a")) {
      link.setAttribute("aria-current", String(link.dataset.lesson === name));
    }
  }

  #listen() {
    byId("lessons").append(...LESSONS.map(({ name, title, link }) => {
      const anchor = element("a", "", title);
      anchor.href = link;
      anchor.dataset.lesson = name;
      return anchor;
    }));
    document.addEventListener("click", (event) => {
      // A link to what is shown already shows it again.
      const link = event.target.closest?.("a[href^='#']");
      if (link && link.getAttribute("href") === location.hash) {
        this.follow(location.hash);
      }
    });
    byId("play").addEventListener("click", () => this.toggle());
    byId("again").addEventListener("click", () => this.#again());
    byId("another").addEventListener("click", () => this.restart(String(Math.floor(Math.random() * 1e6))));
    byId("speed").addEventListener("change", () => { this.other.speed = byId("speed").value; this.#writeLink(); });
    byId("forces").addEventListener("change", () => {
      this.other.forces = byId("forces").checked ? "1" : "0";
      this.#writeLink();
      this.show();
    });
    byId("boat").addEventListener("change", () => this.pin(byId("boat").value === "" ? null : Number(byId("boat").value)));
    byId("scrub").addEventListener("input", () => this.seek(Number(byId("scrub").value)));
    byId("save").addEventListener("click", () => this.save());
    byId("open").addEventListener("change", () => this.open(byId("open").files[0]));
    for (const button of document.querySelectorAll("[data-copies]")) {
      button.addEventListener("click", () => this.#copy(button));
    }
    this.#listenToRudder();
    // Not the address now: the link of what is shown may have been written since.
    window.addEventListener("hashchange", ({ newURL }) => this.follow(new URL(newURL).hash));
    document.addEventListener("keydown", (event) => this.#key(event, true));
    document.addEventListener("keyup", (event) => this.#key(event, false));
    document.addEventListener("dragover", (event) => event.preventDefault());
    document.addEventListener("drop", (event) => {
      event.preventDefault();
      this.open(event.dataTransfer?.files[0]);
    });
    new ResizeObserver(() => this.show()).observe(byId("runs"));
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
      this.palette = colors();
      this.show();
    });
  }

  #listenToRudder() {
    const thumb = byId("thumb");
    // To the left is counter-clockwise for a boat that moves forward.
    thumb.addEventListener("input", () => { this.rudder = -Number(thumb.value); });
    for (const name of ["pointerup", "pointercancel", "blur"]) {
      thumb.addEventListener(name, () => { thumb.value = 0; this.rudder = 0; });
    }
    this.held = new Set();
  }

  #key(event, isDown) {
    const isTyped = event.target.closest?.("input:not(#thumb), select, textarea, summary, dialog");
    if (event.ctrlKey || event.metaKey || event.altKey || (isDown && isTyped)) {
      return;
    }
    if (this.isYours && ["ArrowLeft", "ArrowRight"].includes(event.key)) {
      event.preventDefault();
      this.held[isDown ? "add" : "delete"](event.key);
      this.rudder = Number(this.held.has("ArrowLeft")) - Number(this.held.has("ArrowRight"));
      byId("thumb").value = -this.rudder;
    } else if (isDown && event.key === " " && !event.target.closest?.("button, a, input")) {
      event.preventDefault();
      this.toggle();
    } else if (isDown && event.key === "Escape") {
      this.pin(null);
    }
  }

  async #again() {
    if (this.broken) {
      this.broken = false;
      await this.#attempt(() => this.simulator.start());
    }
    if (!this.broken) {
      await this.restart();
    }
  }

  async #copy(button) {
    const text = button.dataset.copies === "address" ? location.href : byId(button.dataset.copies).value;
    try {
      await navigator.clipboard.writeText(text);
      this.say("Copied.");
    } catch {
      this.say(`The browser does not let this page copy; here it is: ${text}`);
    }
  }

  /** Has the browser keep the recording. */
  save() {
    const [run] = this.runs;
    const { kinds, about } = this;
    const recorded = this.quantities.filter(({ kind }) => kind === "recorded").map(({ key }) => key);
    const bytes = recordingOf(run, { ...about, kinds, recorded, policy: this.shown.flock.leaders ?? "paper's law at every substep" });
    download(bytes, "flock.npz");
    this.say(`The recording holds ${fixed(run.time[run.sampleAt(run.changedAt)], 1)} to ${fixed(run.end, 1)} s; flockenv.Recording.load reads it.`);
  }

  /** Plays a recording's file. */
  async open(file) {
    if (!file) {
      return;
    }
    try {
      const names = this.quantities.map(({ key }) => key);
      const run = await runOfFile(file, {
        series: names,
        phases: this.phases,
        describe: async (request, named) => this.#described((await this.simulator.ask("check", { request })).values, named),
        derive: async (arrays, { target }) => {
          const recorded = Object.fromEntries(names.filter((name) => arrays[`order_${name}`]).map((name) => [name, arrays[`order_${name}`].values]));
          const question = { names, recorded, samples: arrays.time_s.values.length, sign: target === "ccw" ? -1 : 1 };
          return (await this.simulator.ask("derive", question)).series;
        },
      });
      Object.assign(this, { runs: [run], recorded: true, time: run.time[0], values: run.parameters });
      this.#showRuns();
      this.say(`${file.name} plays; “again” returns to the flock.`);
    } catch (error) {
      this.say(`${file.name.slice(0, 60)} cannot be shown: ${error.message}.`);
    }
  }

  /** Shows a boat's numbers and its local frame; null for none. */
  pin(boat) {
    this.pinned = boat;
    byId("boat").value = boat ?? "";
    if (boat === null) {
      delete this.other.boat;
    } else {
      this.other.boat = String(boat);
    }
    this.observed = null;
    this.show();
    if (boat !== null && !this.playing && !this.recorded) {
      this.#look(boat);
    }
  }

  /** Asks what a boat observes, where no time passes. */
  async #look(boat) {
    await this.#attempt(async () => {
      const { taken } = await this.simulator.ask("look", { boat });
      if (boat === this.pinned) {
        this.observed = taken[0].observation;
        this.show();
      }
    });
  }

  seek(time) {
    const [run] = this.runs;
    this.time = Math.min(Math.max(time, run.time[0]), run.end);
    this.playing = false;
    this.#showPlaying();
    this.show();
  }

  toggle() {
    if (this.broken) {
      return;
    }
    this.playing = !this.playing;
    this.#showPlaying();
    if (this.playing) {
      if (this.recorded && this.time >= this.runs[0].end) {
        this.time = this.runs[0].time[0];
      }
      this.before = performance.now();
      requestAnimationFrame((now) => this.#tick(now));
    }
  }

  #showPlaying() {
    byId("play").classList.toggle("playing", this.playing);
    byId("play").setAttribute("aria-label", this.playing ? "Pause" : "Play");
  }

  #tick(now) {
    if (!this.playing) {
      return;
    }
    // A page in the background gets no frames; it continues where it was.
    const passed = Math.min(Math.max(now - this.before, 0), 250) / 1000;
    this.before = now;
    const speed = this.other.speed === "max" ? Infinity : Number(this.other.speed);
    const { end } = this.runs[0];
    const from = this.time;
    this.time = Math.min(this.time + (passed > 0 ? passed * speed : 0), end);
    this.#note(now, this.time - from);
    if (this.recorded) {
      this.playing = this.time < end;
      this.#showPlaying();
    } else {
      const ahead = speed === Infinity ? Infinity : this.time + 0.1 + 0.05 * speed - end;
      this.#advance(Math.ceil(Math.min(10 * ahead, 1e6)));
    }
    this.show(now);
    requestAnimationFrame((next) => this.#tick(next));
  }

  /** Has the simulator take some more samples, unless it is at work already. */
  async #advance(samples) {
    if (this.advancing || this.changing || samples <= 0) {
      return;
    }
    this.advancing = true;
    const { runs } = this;
    const question = { samples, milliseconds: FRAME_WORK, boat: this.pinned ?? NO_BOAT, rudder: this.rudder };
    await this.#attempt(async () => {
      const { taken, milliseconds, memory } = await this.simulator.ask("advance", question);
      this.costs.simulating += milliseconds;
      this.costs.memory = memory;
      // The flocks may have become others meanwhile.
      if (runs === this.runs) {
        taken.forEach((each, place) => {
          runs[place].append(each, place === 0 && runs[0].end > SETTLING ? (order) => this.map.note(runs[0].bw_s, order) : undefined);
        });
        this.observed = taken[0].observation;
      }
    });
    this.advancing = false;
  }

  /** Counts frames, and what of time passed in them. */
  #note(now, passed) {
    this.costs ??= { frames: 0, drawing: 0, simulating: 0 };
    this.costs.frames += 1;
    this.rate ??= { since: now, passed: 0, words: "" };
    this.rate.passed += passed;
    if (now - this.rate.since > 1000) {
      const rate = (1000 * this.rate.passed) / (now - this.rate.since);
      this.rate = { since: now, passed: 0, words: `${fixed(rate, rate < 10 ? 1 : 0)} × real time` };
    }
  }

  show(now = performance.now()) {
    if (this.runs.length === 0) {
      return;
    }
    const start = performance.now();
    const boat = this.hovered ?? this.pinned;
    const trailSeconds = Math.min(TRAIL_SECONDS, TRAIL_BOAT_SECONDS / this.runs[0].boats);
    const options = { trailSeconds, forceScale: byId("forces").checked ? FORCE : null, boat, palette: this.palette };
    for (const panel of this.panels) {
      panel.show(this.time, options);
      if (this.pinned !== null && !this.isYours && panel.canvas.clientWidth > 0) {
        drawLapFrame(panel.scene, this.pinned);
      }
    }
    for (const [chart, key] of this.charts) {
      chart.draw(this.time, this.quantities.find((each) => each.key === key), this.palette);
    }
    this.map.draw(this.palette);
    if (!this.playing || !(now - this.worded < WORDS_EVERY)) {
      this.worded = now;
      this.#showWords();
    }
    if (this.costs) {
      this.costs.drawing += performance.now() - start;
    }
  }

  #showWords() {
    const [run] = this.runs;
    // While a flock plays, the time above its picture runs ahead of words that are written more rarely.
    byId("clock").textContent = this.playing && !this.recorded ? this.rate?.words ?? "" : `${fixed(this.time, 1)} s`;
    Object.assign(byId("scrub"), { min: run.time[0], max: run.end, value: this.time });
    byId("scrub").setAttribute("aria-valuetext", `${fixed(this.time, 1)} s`);
    for (const [, key] of this.charts) {
      const quantity = this.quantities.find((each) => each.key === key);
      byId(key).previousElementSibling.replaceChildren(...legendOf(this.runs, quantity, this.time));
    }
    const scores = this.runs.filter(({ target }) => target !== null);
    byId("score").replaceChildren(...(scores.length === 0 ? [] : ["mean order towards the target so far: ",
      ...scores.flatMap((each, place) => [`${place > 0 ? " · " : ""}${this.runs.length > 1 ? `${each.name} ` : ""}`,
        element("b", "", fixed(each.score, 2, true))])]));
    this.#showObserved();
  }

  #showObserved() {
    const isLeader = this.pinned !== null && this.pinned < this.runs[0].leaders && !this.recorded;
    byId("observes").hidden = !isLeader;
    if (!isLeader || !byId("observes").open || this.observed?.length !== this.entries.length) {
      byId("observation").replaceChildren();
      return;
    }
    const table = element("table");
    this.entries.forEach(([block, count, name, , meaning], place) => {
      const row = element("tr");
      row.append(element("th", "", block === "neighbors" ? `neighbor ${Number(count) + 1}: ${name}` : name),
        element("td", "", fixed(this.observed[place], 2, true)), element("td", "faint", meaning));
      table.append(row);
    });
    byId("observation").replaceChildren(table);
  }

  #showTexts() {
    const seconds = 480;
    const { flock } = this.shown;
    const isYours = flock.leaders === "you";
    const flocks = [isYours ? { ...flock, leaders: "paper's law at every substep" } : flock];
    if (this.shown.beside && !isYours) {
      flocks.push({ ...flock, ...this.shown.beside });
    }
    const commands = flocks.map((each) => commandLine(each, seconds));
    byId("command").value = commands.join("\n").trim();
    byId("python").value = pythonText(flocks, seconds, this.kinds);
    byId("same").textContent = [
      isYours ? "Your own rudders are in the recording alone: these run the law in your place." : "",
      commands.includes("") ? "No command gives each leader a policy of its own, as Python does." : "",
    ].join("");
  }

  /** Brings the page's link up to date, soon: not more often than browsers allow. */
  #writeLink() {
    this.linkDue ??= setTimeout(() => {
      this.linkDue = undefined;
      if (!this.recorded && location.protocol !== "about:") {
        history.replaceState(null, "", linkTo({ ...this.shown, other: this.other }));
      }
    }, LINK_AFTER);
  }
}
