// Sliders and choices, one for each parameter that the page lets a visitor change.

import { element, plain } from "../flockenv/replay/shared/words.mjs";
import { YOU } from "./laws.mjs";
import { MOST_NOISE } from "./order_map.mjs";

/** Sliders, by the element that holds them: parameter, words, least, most, step, and a unit for screen readers. */
const SLIDERS = {
  noise: [["bw_s", "backward duration (s)", 0, MOST_NOISE, 0.05, "seconds"]],
  sliders: [
    ["n_boats", "boats", 2, 300, 1],
    ["n_leaders", "leaders", 0, 8, 1],
    ["c4", "angular noise", 0, 0.5, 0.01],
    ["boat_shape", "hull shape", 0, 2, 0.05],
  ],
};

/** Choices, by the element that holds them: parameter, words, and accepted values with their words. */
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

/** Choices of a flock beside the first that differs in its number of leaders. */
const NUMBERS_BESIDE = [["n_leaders=0", "no leaders"], ["n_leaders=1", "one leader"], ["n_leaders=4", "four leaders"]];

/** The targets of opposed leaders: the first half clockwise, the others counter-clockwise. */
export function opposedTargets(leaders) {
  return Array.from({ length: leaders }, (_, k) => (k < leaders / 2 ? "cw" : "ccw")).join(",");
}

/** The multiple of a slider's step that is nearest to a value. */
const onGrid = (value, step) => step * Math.round(value / step);

export class Controls {
  /** For each control by its parameter, a function that shows a value in it. */
  inputs = new Map();

  /** `meanings`: the meaning of each parameter, shown as its title; `change` gets a name and a value. */
  constructor(meanings, laws, change) {
    Object.assign(this, { meanings, laws, change });
    const byId = (id) => document.getElementById(id);
    for (const [id, sliders] of Object.entries(SLIDERS)) {
      byId(id).append(...sliders.map(([name, words, low, high, step, unit]) => this.#slider(name, words, { low, high, step, unit })));
    }
    const policies = laws.sharedChoices.map((name) => [name, laws.words(name)]);
    const beside = policies.filter(([name]) => name !== YOU).map(([name, words]) => [`leaders=${name}`, words]);
    byId("choices").append(this.#choice("leaders", "leaders steer by", [...policies, ["each", "each its own"]]),
      this.#choice("beside", "beside it", [["", "nothing"], ...beside, ...NUMBERS_BESIDE]));
    for (const [id, choices] of Object.entries(CHOICES)) {
      byId(id).append(...choices.map(([name, words, options]) => this.#choice(name, words, options)));
    }
  }

  #slider(name, words, { low, high, step, unit }) {
    const label = element("label");
    const [text, value, input] = [element("span", "", words), element("output"), element("input")];
    // A screen reader reads the value from the slider, so it need not read the output.
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
    const policies = values.leaders.includes(",") ? values.leaders.split(",") : [];
    for (const [name, showValue] of this.inputs) {
      showValue(name === "leaders" && policies.length > 0 ? "each" : values[name] ?? "");
    }
    const container = document.getElementById("each");
    if (container.childElementCount !== policies.length) {
      container.replaceChildren(...policies.map((_, leader) => this.#leaderChoice(container, leader)));
    }
    policies.forEach((policy, leader) => { container.children[leader].querySelector("select").value = policy; });
  }

  #leaderChoice(container, leader) {
    const label = element("label", "", `leader ${leader} `);
    const select = element("select");
    select.append(...this.laws.leaderChoices.map((name) => new Option(this.laws.words(name), name)));
    const chosen = () => Array.from(container.querySelectorAll("select"), ({ value }) => value).join(",");
    select.addEventListener("change", () => this.change("leaders", chosen()));
    label.append(select);
    return label;
  }
}
