// The clock of the page: playing, scrubbing, keys, and what is shown.

const SPEEDS = [0.25, 0.5, 1, 2, 4, 8, 16, 32, 64];
const FAR = 10;

class Player {
  constructor(runs) {
    this.runs = runs;
    this.controls = Object.fromEntries(
      ["play", "back", "forward", "scrub", "clock", "speed", "trails", "forces", "quantity", "legend"]
        .map((id) => [id, document.getElementById(id)]),
    );
    [this.begin, this.end] = span(runs);
    this.time = this.begin;
    this.playing = false;
    this.hovered = this.pinned = null;
    this.palette = colors();
    this.panels = runs.map((run, place) => new Panel(run, place, runs.length > 1));
    document.getElementById("runs").append(...this.panels.map((panel) => panel.root));
    document.body.classList.toggle("pair", runs.length > 1);
    const seek = (time) => this.seek(time);
    this.charts = [
      new Chart(document.getElementById("detail"), runs, 30, seek),
      new Chart(document.getElementById("overview"), runs, null, seek),
    ];
    this.#fill();
    this.#listen();
    this.show();
  }

  get speed() {
    return Number(this.controls.speed.value);
  }

  get boat() {
    return this.hovered ?? this.pinned;
  }

  #fill() {
    const { speed, quantity, scrub, forces } = this.controls;
    SPEEDS.forEach((each) => speed.append(new Option(`${each} ×`, each, each === 1, each === 1)));
    QUANTITIES.forEach(({ key, words, unit }) => {
      const isThere = this.runs.some((run) => run.columns.has(key));
      quantity.append(new Option(unit ? `${words} (${unit})` : words, key));
      quantity.lastChild.disabled = !isThere;
    });
    [scrub.min, scrub.max, scrub.value] = [this.begin, this.end, this.begin];
    if (!this.runs.some((run) => run.hasForces)) {
      forces.checked = false;
      forces.disabled = true;
      document.getElementById("forces-label").title = "These recordings hold no contacts: record them with contacts=True";
    }
    fillParameters(this.runs);
  }

  #listen() {
    const { play, back, forward, scrub, speed, trails, forces, quantity } = this.controls;
    play.addEventListener("click", () => this.toggle());
    back.addEventListener("click", () => this.step(-1));
    forward.addEventListener("click", () => this.step(1));
    scrub.addEventListener("input", () => this.seek(Number(scrub.value)));
    for (const each of [speed, trails, forces, quantity]) {
      each.addEventListener("change", () => this.show());
    }
    for (const panel of this.panels) {
      const boatAt = (event) => {
        const box = panel.canvas.getBoundingClientRect();
        return panel.scene.boatAt(event.clientX - box.left, event.clientY - box.top);
      };
      panel.canvas.addEventListener("pointermove", (event) => this.hover(boatAt(event)));
      panel.canvas.addEventListener("pointerleave", () => this.hover(null));
      panel.canvas.addEventListener("click", (event) => {
        const boat = boatAt(event);
        this.pinned = boat === this.pinned ? null : boat;
        this.show();
      });
    }
    document.addEventListener("keydown", (event) => this.#key(event));
    new ResizeObserver(() => this.show()).observe(document.getElementById("runs"));
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
      this.palette = colors();
      this.show();
    });
  }

  #key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || event.target.closest("select, summary")) {
      return;
    }
    if (event.key === " " && event.target.closest("button, input[type=checkbox]")) {
      return;
    }
    const actions = {
      " ": () => this.toggle(),
      ArrowLeft: () => (event.shiftKey ? this.seek(this.time - FAR) : this.step(-1)),
      ArrowRight: () => (event.shiftKey ? this.seek(this.time + FAR) : this.step(1)),
      Home: () => this.seek(this.begin),
      End: () => this.seek(this.end),
      "+": () => this.#choose("speed", 1),
      "-": () => this.#choose("speed", -1),
      t: () => this.#choose("trails", 1, true),
      f: () => this.controls.forces.click(),
      "]": () => this.#pin(1),
      "[": () => this.#pin(-1),
      Escape: () => { this.pinned = null; this.show(); },
    };
    if (event.key in actions) {
      event.preventDefault();
      actions[event.key]();
    }
  }

  #choose(name, by, around = false) {
    const select = this.controls[name];
    const count = select.options.length;
    const next = select.selectedIndex + by;
    select.selectedIndex = around ? next % count : Math.min(Math.max(next, 0), count - 1);
    this.show();
  }

  #pin(by) {
    const boats = Math.max(...this.runs.map((run) => run.boats));
    this.pinned = this.pinned === null ? 0 : (this.pinned + by + boats) % boats;
    this.show();
  }

  hover(boat) {
    if (boat !== this.hovered) {
      this.hovered = boat;
      this.show();
    }
  }

  toggle() {
    this.playing = !this.playing;
    if (this.playing) {
      if (this.time >= this.end) {
        this.time = this.begin;
      }
      this.before = performance.now();
      requestAnimationFrame((now) => this.#tick(now));
    } else {
      this.time = this.#sampled(this.time);
    }
    this.show();
  }

  /** The last time, up to this one, at which a run has a sample. */
  #sampled(time) {
    return Math.max(this.begin, ...this.runs.map((run) => run.time[run.sampleAt(time)]).filter((each) => each <= time + 1e-9));
  }

  /** One sample back or on, of whichever run has the next one. */
  step(by) {
    this.playing = false;
    const next = (run) => run.time[Math.min(run.sampleAt(this.time) + 1, run.length - 1)];
    const later = this.runs.map(next).filter((time) => time > this.time + 1e-9);
    this.seek(by < 0 ? this.time - 1e-6 : Math.min(this.end, ...later));
  }

  /** Goes to the last sample up to a time, so that picture and numbers belong together. */
  seek(time) {
    this.time = this.#sampled(Math.min(Math.max(time, this.begin), this.end));
    this.before = performance.now();
    this.request();
  }

  /** Shows the page once before the next frame, however often it is asked to. */
  request() {
    this.requested ??= requestAnimationFrame(() => this.show());
  }

  #tick(now) {
    if (!this.playing) {
      return;
    }
    // A page in the background gets no frames; it goes on where it was.
    const passed = Math.min(Math.max(now - this.before, 0), 250) / 1000;
    this.before = now;
    this.time = Math.min(this.time + passed * this.speed, this.end);
    this.playing = this.time < this.end;
    this.show();
    requestAnimationFrame((next) => this.#tick(next));
  }

  show() {
    cancelAnimationFrame(this.requested);
    this.requested = null;
    const { play, scrub, clock, trails, forces, quantity } = this.controls;
    const options = {
      trailSeconds: Number(trails.value),
      forces: forces.checked,
      boat: this.boat,
      palette: this.palette,
    };
    this.panels.forEach((panel) => panel.show(this.time, options));
    const chosen = QUANTITIES.find(({ key }) => key === quantity.value);
    this.charts.forEach((chart) => chart.draw(this.time, chosen, this.palette));
    play.classList.toggle("playing", this.playing);
    play.setAttribute("aria-label", this.playing ? "Pause" : "Play");
    scrub.value = this.time;
    scrub.style.setProperty("--done", `${(100 * (this.time - this.begin)) / (this.end - this.begin || 1)}%`);
    clock.textContent = `${fixed(this.#sampled(this.time), 1)} s of ${fixed(this.end, 1)} s`;
    scrub.setAttribute("aria-valuetext", clock.textContent);
    this.#legend(chosen);
  }

  #legend(chosen) {
    const parts = this.runs.map((run, place) => {
      const part = element("span", "value");
      if (this.runs.length > 1) {
        part.append(element("span", `swatch run-${place + 1}`));
      }
      const value = run.value(chosen.key, run.sampleAt(this.time));
      part.append(element("b", "", fixed(value, chosen.decimals)));
      return part;
    });
    const words = chosen.unit ? `${chosen.words} (${chosen.unit})` : chosen.words;
    this.controls.legend.replaceChildren(element("span", "", words), ...parts);
  }
}

/** A table of the parameters; those that differ between runs stand out. */
function fillParameters(runs) {
  const table = element("table");
  const rows = [["", (run) => run.name], ["seed", (run) => run.seed], ["version", (run) => run.version],
    ...Object.keys(runs[0].parameters).map((key) => [key, (run) => run.parameters[key]])];
  for (const [name, value] of rows) {
    const values = runs.map(value);
    const row = element("tr", new Set(values).size > 1 ? "differs" : "");
    row.append(element("th", "", name), ...values.map((each) => element("td", "", each)));
    table.append(row);
  }
  document.getElementById("parameters").append(table);
}

async function start() {
  const facts = JSON.parse(document.getElementById("data").textContent);
  const runs = await Promise.all(facts.map(async (fact) => new Run(fact, await unpack(fact.data))));
  window.player = new Player(runs);
  const thinned = Math.max(...runs.map((run) => run.every));
  document.getElementById("detail-caption").textContent = "shaded: analysis window";
  document.getElementById("note").textContent =
    (thinned > 1 ? `Every ${thinned}th sample is shown. ` : "") +
    "Between samples boats are drawn on straight lines. Click a boat to keep its numbers. " +
    "Keys: space, ← →, shift ← →, + −, t trails, f forces, [ ] boats.";
  document.body.dataset.ready = "true";
}

start().catch((error) => {
  document.getElementById("note").textContent = `This page is damaged, or the browser too old: ${error.message}`;
  document.body.dataset.ready = "failed";
});
