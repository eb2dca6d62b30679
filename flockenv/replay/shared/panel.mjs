// A run's panel: its picture, the legend around it, and a card with a boat's numbers.

import { barOf } from "./forces.mjs";
import { Scene } from "./scene.mjs";
import { element, fixed, withSign, wrapped } from "./words.mjs";

/** What the motors do in each phase of their cycle. */
const PHASES = {
  fw: ["forward", "the motors drive the boats forward"],
  nop1: ["off", "the motors are off, and the boats drift forward"],
  bw: ["backward", "the motors drive the boats backward"],
  nop2: ["off", "the motors are off, and the boats drift backward"],
};

/** A leader's target in words, unless all leaders share it. */
function targetWords(run, boat) {
  return run.targets ? ` ${run.targets[boat] === "cw" ? "↻ cw" : "↺ ccw"}` : "";
}

/** The legend's entries for leaders, one for each target: role, number of leaders, target in words. */
function leaderKey(run) {
  if (!run.targets) {
    return [["leader", run.leaders, ""]];
  }
  return ["cw", "ccw"].map((target) => {
    const first = run.targets.indexOf(target);
    return [run.roleOf(first), run.targets.filter((other) => other === target).length, targetWords(run, first)];
  });
}

/** Meaning of the colors of directions. */
export function colorKey() {
  return [["clockwise", "clockwise"], ["counter-clockwise", "counter-clockwise"], ["radial", "neither, as in a jam"]].map(([name, words]) => {
    const part = element("span");
    part.append(element("span", `swatch ${name}`), words);
    return part;
  });
}

/** Buttons that choose which of two runs a narrow window shows; `show` draws it. */
export function runSwitch(runs, show) {
  const group = element("div", "switch");
  group.setAttribute("role", "group");
  group.setAttribute("aria-label", "The run that is shown");
  const buttons = runs.map((run, index) => {
    const button = element("button", "wide");
    button.type = "button";
    button.append(element("span", `swatch ${run.color}`), run.name);
    button.addEventListener("click", () => { choose(index); show(); });
    return button;
  });
  const choose = (chosen) => {
    document.body.dataset.shown = String(chosen);
    buttons.forEach((button, index) => { button.setAttribute("aria-pressed", String(index === chosen)); });
  };
  group.append(...buttons);
  choose(Number(document.body.dataset.shown ?? 0));
  return group;
}

/** A run's canvas with everything around it. With `isOneOfTwo` the run's name has the run's color. */
export class Panel {
  /** The boat and the radius of the hole for which the card's position was chosen. */
  #placement = "";

  constructor(run, index, isOneOfTwo) {
    this.run = run;
    this.root = element("article", "run");
    this.root.dataset.run = String(index);
    const title = element("h2");
    const swatch = element("span", `swatch ${run.color}`);
    title.append(...(isOneOfTwo ? [swatch] : []), element("span", "name", run.name),
      element("span", "faint origin", run.ids ? "tracks" : `seed ${run.seed} · flockenv ${run.version}`));
    this.picture = element("div", "picture");
    this.canvas = element("canvas");
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", `Boats of ${run.name}; keys [ and ] choose a boat`);
    this.card = element("div", "card");
    this.card.hidden = true;
    this.picture.append(this.#clockCorner(), this.#settingsCorner(), this.canvas, this.#orderCorner(), this.#rotationCorner(), this.card);
    this.root.append(title, this.picture);
    this.scene = new Scene(this.canvas, run);
  }

  /** Calls `hover` with the boat under the pointer, and `choose` with the boat that is clicked; null for none. */
  onBoat(hover, choose) {
    const boatAt = (event) => {
      const box = this.canvas.getBoundingClientRect();
      return this.scene.boatAt(event.clientX - box.left, event.clientY - box.top);
    };
    this.canvas.addEventListener("pointermove", (event) => hover(boatAt(event)));
    this.canvas.addEventListener("pointerleave", () => hover(null));
    this.canvas.addEventListener("click", (event) => choose(boatAt(event)));
  }

  #clockCorner() {
    const corner = element("div", "corner top left");
    this.time = element("div", "time");
    const phases = element("div", "phases");
    this.phases = this.run.phases.map((name) => {
      const [words, meaning] = PHASES[name] ?? [name, ""];
      const phase = element("span", "phase", words);
      phase.dataset.phase = name;
      phase.title = `${name}, ${this.run.parameters[`${name}_s`]} s: ${meaning}`;
      return phase;
    });
    const heading = element("span", "faint", "motors");
    heading.title = "The phase of the cycle that the motors of all boats go through together";
    phases.append(heading, ...this.phases);
    corner.append(this.time, ...(this.phases.length > 0 ? [phases] : []));
    return corner;
  }

  #settingsCorner() {
    const { run } = this;
    const corner = element("div", "corner top right");
    if (run.target !== null) {
      corner.append(element("div", "target", run.target === "cw" ? "target ↻ cw" : "target ↺ ccw"));
    }
    if (!run.ids) {
      const backward = element("div", "", `backward ${fixed(run.bw_s, 2)} s`);
      backward.title = "bw_s, how long the boats back up in each cycle: the longer, the noisier";
      corner.append(backward);
    }
    if (run.leaders > 0) {
      for (const [role, count, words] of leaderKey(run)) {
        const leaders = element("div");
        leaders.append(element("span", `swatch ${role}`), `${count} leader${count > 1 ? "s" : ""}${words}`);
        corner.append(leaders);
      }
    }
    this.forceKey = element("div", "force-key");
    this.forceKey.title = "A bar lies on the boat that is pushed. It grows with the force: up to half a boat long, then wider";
    this.forceBar = element("span", "force-bar");
    this.forceWords = element("span");
    this.forceKey.append(this.forceBar, this.forceWords);
    corner.append(this.forceKey);
    return corner;
  }

  #orderCorner() {
    const corner = element("div", "corner bottom left");
    this.phi = element("span", "phi");
    this.psi = element("span", "psi");
    this.psiBar = element("div", "bar");
    const [angle, line, gauge] = [element("div"), element("div"), element("div", "gauge")];
    angle.append("angle φₒ ", this.phi, " rad");
    line.append("order Ψₒ ", this.psi);
    gauge.append(this.psiBar);
    corner.append(angle, line, gauge);
    return corner;
  }

  /** The signed order, or the rotation of a run without leaders. */
  #rotationCorner() {
    const hasTarget = this.run.target !== null;
    this.signedKey = hasTarget ? "signed_order" : "rotation";
    const corner = element("div", "corner bottom right");
    this.signed = element("span", "signed");
    this.signedBar = element("div", "bar");
    const [line, gauge] = [element("div"), element("div", "gauge middle")];
    line.append(hasTarget ? "signed order " : "rotation ", this.signed);
    gauge.append(this.signedBar);
    corner.append(line, gauge);
    return corner;
  }

  /** Shows the run at a time in s; `options`: those of `Scene.draw`. */
  show(time, options) {
    const { run } = this;
    if (this.canvas.clientWidth === 0) {
      return;
    }
    const sample = run.sampleAt(time);
    this.root.dataset.sample = String(sample);
    this.scene.draw(time, options);
    this.time.textContent = `${fixed(run.time[sample], 1)} s`;
    const phase = run.phase(sample);
    for (const phaseElement of this.phases) {
      phaseElement.classList.toggle("now", phaseElement.dataset.phase === phase);
    }
    this.psi.textContent = fixed(run.value("psi_o", sample), 2);
    this.phi.textContent = withSign(run.value("phi_o", sample), 2);
    const signed = run.value(this.signedKey, sample);
    this.signed.textContent = withSign(signed, 2);
    this.psiBar.style.width = `${100 * (run.value("psi_o", sample) ?? 0)}%`;
    this.signedBar.style.width = `${50 * Math.abs(signed ?? 0)}%`;
    this.signedBar.style.left = `${signed < 0 ? 50 + 50 * signed : 50}%`;
    this.#showForceKey(options.forceScale);
    this.#showCard(options.boat, sample);
  }

  #showForceKey(forceScale) {
    this.forceKey.hidden = forceScale === null || !this.run.hasForces;
    if (!this.forceKey.hidden) {
      const hull = 2 * this.run.lengths.hull_radius_cm * this.scene.scale;
      // The bar of a force equal to the scale. No length is too long for it.
      const { length, width } = barOf(forceScale, forceScale, Infinity);
      Object.assign(this.forceBar.style, { width: `${length * hull}px`, height: `${Math.max(width * hull, 2)}px` });
      this.forceWords.textContent = `force ${forceScale} cm/s²`;
    }
  }

  #showCard(boat, sample) {
    const isShown = boat !== null && boat < this.run.boats && this.run.isPresent(boat, sample);
    this.card.hidden = !isShown;
    if (!isShown) {
      return;
    }
    const head = element("div", "head", this.run.nameOf(boat));
    head.append(element("span", "faint", boat < this.run.leaders ? ` leader${targetWords(this.run, boat)}` : ""));
    const list = element("dl");
    for (const [name, value, unit, meaning] of boatNumbers(this.run, boat, sample)) {
      const definition = element("dd", "", value);
      definition.dataset.number = name;
      const term = element("dt", "", name);
      term.title = meaning ?? "";
      list.append(term, definition, element("dd", "faint", unit));
    }
    this.card.replaceChildren(head, list);
    this.#placeCard(boat);
  }

  /** Puts the card into the hole of the pool if it fits, otherwise below the picture, so that it never covers the flock. */
  #placeCard(boat) {
    const { card, canvas, scene } = this;
    const hole = (this.run.lengths.inner_radius_cm ?? 0) * scene.scale;
    const placement = `${boat} ${hole}`;
    if (placement !== this.#placement) {
      this.#placement = placement;
      // A copy is measured: if the card itself left the page for an instant, the page would be shorter, and scroll back.
      const copy = card.cloneNode(true);
      copy.className = "card inside";
      this.picture.append(copy);
      // Longer numbers may follow, so some margin is left.
      card.classList.toggle("inside", Math.hypot(copy.offsetWidth, copy.offsetHeight) / 2 < 0.96 * hole);
      copy.remove();
    }
    const [x, y] = scene.pixel(0, 0);
    card.style.left = `${canvas.offsetLeft + x}px`;
    card.style.top = `${canvas.offsetTop + y}px`;
  }
}

/** A boat's numbers at a sample: name, value, unit and, if the name says too little, its meaning. */
export function boatNumbers(run, boat, sample) {
  const at = (name, channel) => run.columns.get(name).at(sample, channel);
  const numbers = [
    ["x", fixed(at("position_cm", 2 * boat), 1), "cm"],
    ["y", fixed(at("position_cm", 2 * boat + 1), 1), "cm"],
    ["heading", fixed(wrapped(at("heading", boat)), 2), "rad"],
    ["speed", fixed(at("speed_cm_s", boat), 1), "cm/s"],
    ["turning", withSign(at("turning_rate", boat), 2), "rad/s"],
  ];
  if (boat < run.leaders) {
    numbers.push(
      ["φ", withSign(wrapped(run.orientation(boat, sample)), 2), "rad",
        "orientation in the local frame: 0 points outward, +π/2 clockwise"],
      ["rudder", withSign(run.rudder(boat, sample), 2), "",
        "from −1 to 1; positive turns counter-clockwise when moving forward"],
    );
  }
  if (run.hasForces) {
    const touching = run.contacts(sample).filter(({ i, j }) => i === boat || j === boat);
    const strongest = Math.max(0, ...touching.map(({ force }) => force));
    numbers.push(["contacts", String(touching.length), ""], ["strongest push", fixed(strongest, 1), "cm/s²"]);
  }
  return numbers;
}

/** A table of the parameters; those that differ between runs stand out. */
export function parameterTable(runs) {
  const table = element("table");
  table.setAttribute("aria-label", "Parameters");
  const rows = [["", (run) => run.name], ["seed", (run) => run.seed], ["version", (run) => run.version],
    ...Object.keys(runs[0].parameters).map((key) => [key, (run) => run.parameters[key]])];
  for (const [name, textOfRun] of rows) {
    const values = runs.map(textOfRun);
    const row = element("tr", new Set(values).size > 1 ? "differs" : "");
    row.append(element("th", "", name), ...values.map((text) => element("td", "", text)));
    table.append(row);
  }
  return table;
}
