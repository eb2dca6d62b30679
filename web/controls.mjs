// Sliders and choices, one for each parameter that the page lets a visitor change.

import { element, plain } from "../flockenv/replay/shared/words.mjs";
import { YOU } from "./laws.mjs";
import { MOST_NOISE } from "./order_map.mjs";

/** Sliders: parameter, words, least, most, step, and a unit to read aloud. The first is the one that everybody needs. */
const SLIDERS = {
  noise: [["bw_s", "backward duration (s)", 0, MOST_NOISE, 0.05, "seconds"]],
  sliders: [
    ["n_boats", "boats", 2, 300, 1],
    ["n_leaders", "leaders", 0, 8, 1],
    ["c4", "angular noise", 0, 0.5, 0.01],
    ["boat_shape", "hull shape", 0, 2, 0.05],
  ],
};

/** Choices: parameter, words, and accepted values with their words. */
const CHOICES = {
  choices: [
    ["pool", "pool", [["wide"], ["narrow"], ["180,0", "dish"], ["inf,0", "open water"]]],
    ["target", "target", [["cw", "clockwise"], ["ccw", "counter-clockwise"], ["opposed", "opposed"]]],
  ],
  "further-choices": [
    ["preset", "preset", [["simulation"], ["paper"], ["experiment"]]],
    ["scheme", "scheme", [["leapfrog"], ["moreau"], ["paper"]]],
    ["noise_scheme", "noise", [["white"], ["per-step"]]],
  ],
};

/** Numbers of leaders that may run beside a flock, in words. */
const NUMBERS_BESIDE = [["n_leaders=0", "no leaders"], ["n_leaders=1", "one leader"], ["n_leaders=4", "four leaders"]];

/** The targets of this number of leaders, half of them against the other half. */
export function opposedTargets(leaders) {
  return Array.from({ length: leaders }, (_, k) => (k < leaders / 2 ? "cw" : "ccw")).join(",");
}

/** The nearest value on a slider with this step. */
const onGrid = (value, step) => step * Math.round(value / step);

export class Controls {
  inputs = new Map();

  /** `meanings`: what the simulator says of each parameter; `change` gets a name and a value. */
  constructor(meanings, laws, change) {
    Object.assign(this, { meanings, laws, change });
    const byId = (id) => document.getElementById(id);
    for (const [id, sliders] of Object.entries(SLIDERS)) {
      byId(id).append(...sliders.map(([name, words, low, high, step, unit]) => this.#slider(name, words, { low, high, step, unit })));
    }
    const known = laws.ofAll.map((name) => [name, laws.words(name)]);
    const beside = known.filter(([name]) => name !== YOU).map(([name, words]) => [`leaders=${name}`, words]);
    byId("choices").append(this.#choice("leaders", "leaders steer by", [...known, ["each", "each its own"]]),
      this.#choice("beside", "beside it", [["", "nothing"], ...beside, ...NUMBERS_BESIDE]));
    for (const [id, choices] of Object.entries(CHOICES)) {
      byId(id).append(...choices.map(([name, words, options]) => this.#choice(name, words, options)));
    }
  }

  #slider(name, words, { low, high, step, unit }) {
    const label = element("label");
    const [text, value, input] = [element("span", "", words), element("output"), element("input")];
    // The slider itself says its value.
    value.ariaLive = "off";
    Object.assign(input, { type: "range", min: low, max: high, step, id: name, title: this.meanings[name] ?? "" });
    input.setAttribute("aria-label", words.replace(/ \(.*/, ""));
    input.addEventListener("input", () => this.change(name, plain(onGrid(Number(input.value), step)).replace("−", "-")));
    label.append(text, value, input);
    this.inputs.set(name, (shown) => {
      // A slider rounds a value to one of its steps, and a screen reader would read the rounded
      // value.
      input.step = Math.abs(onGrid(Number(shown), step) - Number(shown)) > 1e-9 ? "any" : step;
      input.value = shown;
      value.textContent = plain(Number(shown));
      input.setAttribute("aria-valuetext", unit ? `${value.textContent} ${unit}` : value.textContent);
    });
    return label;
  }

  #choice(name, words, options) {
    const label = element("label", "", `${words} `);
    const select = element("select");
    Object.assign(select, { id: name, title: this.meanings[name] ?? "" });
    select.append(...options.map(([value, shown]) => new Option(shown ?? value, value)));
    select.addEventListener("change", () => this.change(name, select.value));
    label.append(select);
    this.inputs.set(name, (shown) => {
      select.querySelector("[data-other]")?.remove();
      if (![...select.options].some(({ value }) => value === shown)) {
        const other = new Option(shown.length > 24 ? `${shown.slice(0, 24)}…` : shown, shown);
        other.dataset.other = "true";
        select.append(other);
      }
      select.value = shown;
    });
    return label;
  }

  /** Shows these values, and a separate choice for each leader if their policies differ. */
  show(values) {
    const own = values.leaders.includes(",") ? values.leaders.split(",") : [];
    for (const [name, set] of this.inputs) {
      set(name === "leaders" && own.length > 0 ? "each" : values[name] ?? "");
    }
    const each = document.getElementById("each");
    if (each.childElementCount !== own.length) {
      each.replaceChildren(...own.map((_, leader) => this.#ownChoice(each, leader)));
    }
    own.forEach((policy, leader) => { each.children[leader].querySelector("select").value = policy; });
  }

  #ownChoice(each, leader) {
    const label = element("label", "", `leader ${leader} `);
    const select = element("select");
    select.append(...this.laws.ofEach.map((name) => new Option(this.laws.words(name), name)));
    const chosen = () => Array.from(each.querySelectorAll("select"), ({ value }) => value).join(",");
    select.addEventListener("change", () => this.change("leaders", chosen()));
    label.append(select);
    return label;
  }
}
