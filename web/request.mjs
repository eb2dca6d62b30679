// What the page shows, as its link has it: parameters by name, a seed, how leaders steer, and a second flock beside.

import { ignoredPart } from "../flockenv/replay/shared/link.mjs";

/** What else than parameters of flocks a link may hold: accepted values, in words and as a test. */
export const OTHER = {
  speed: ["one of 1, 2, 4, 8, 16, 32, 64 and max", (text) => SPEEDS.includes(text)],
  boat: ["the number of a boat", (text) => /^\d{1,3}$/.test(text)],
  forces: ["0 or 1", (text) => /^[01]$/.test(text)],
  colors: ["direction or role", (text) => ["direction", "role"].includes(text)],
  start: ["a whole number of seconds up to 600", (text) => /^\d{1,3}$/.test(text) && Number(text) <= 600],
  lesson: ["a word", (text) => /^[a-z-]{1,20}$/.test(text)],
};
export const SPEEDS = ["1", "2", "4", "8", "16", "32", "64", "max"];
/** What this page shows at most, of fields that may be larger elsewhere. */
const LIMITS = { n_boats: [2, 300], n_leaders: [0, 8], dt_s: [0.001, 1] };
/** Fields of a request that are no parameters. */
const STRINGS = ["preset", "seed", "leaders"];
/** Of the second flock: what of it differs from the first. */
const BESIDE = "beside.";

/**
 * What a fragment asks for: `flock` and `beside` (null: none) hold parameters by name, `other` the rest, and
 * `ignored` a sentence for each part that cannot be followed.
 */
export function readLink(fragment, fields) {
  const wanted = { flock: {}, beside: null, other: {}, ignored: [] };
  const refuse = (key, text, why) => wanted.ignored.push(ignoredPart(key, text, why));
  for (const [key, text] of new URLSearchParams(fragment.replace(/^#/, ""))) {
    const isBeside = key.startsWith(BESIDE);
    const name = isBeside ? key.slice(BESIDE.length) : key;
    if (!isBeside && Object.hasOwn(OTHER, name)) {
      const [words, isAccepted] = OTHER[name];
      if (isAccepted(text)) {
        wanted.other[name] = text;
      } else {
        refuse(key, text, `${name} is ${words}`);
      }
    } else if (![...STRINGS, ...fields].includes(name) || /[\n\r]/.test(text)) {
      refuse(key, text, "this page knows no such parameter");
    } else if (Object.hasOwn(LIMITS, name) && !isWithin(LIMITS[name], text)) {
      refuse(key, text, `${name} is ${LIMITS[name].join(" to ")} on this page`);
    } else if (isBeside) {
      wanted.beside = { ...wanted.beside, [name]: text };
    } else {
      wanted.flock[name] = text;
    }
  }
  return wanted;
}

function isWithin([low, high], text) {
  const value = text.trim() === "" ? NaN : Number(text);
  return value >= low && value <= high;
}

/** The fragment for what is shown. */
export function linkTo({ flock, beside, other }) {
  const pairs = [...Object.entries(flock), ...Object.entries(beside ?? {}).map(([name, value]) => [BESIDE + name, value]),
    ...Object.entries(other)];
  return `#${new URLSearchParams(pairs).toString().replaceAll("%2C", ",").replaceAll("%3B", ";")}`;
}

/** A field's value as JSON, from the text that links have: lists with commas, rows that semicolons end. */
export function valueFrom(kind, text) {
  // What is no number stays text, for the simulator to refuse.
  const number = (each) => (each.trim() !== "" && Number.isFinite(Number(each)) ? Number(each) : each.trim());
  const list = (each, read) => each.split(",").filter((item) => item.trim() !== "").map(read);
  if (kind === "rows") {
    return text.split(";").filter(Boolean).map((row) => list(row, number));
  }
  if (kind === "flag") {
    return { true: true, false: false }[text] ?? text;
  }
  if (text.includes(",") && ["pool", "choices"].includes(kind)) {
    return list(text, kind === "pool" ? number : (name) => name.trim());
  }
  return kind === "count" || kind === "real" ? number(text) : text;
}

/** The text that links have for a value. */
export function textOf(value) {
  const isRows = Array.isArray(value) && Array.isArray(value[0]);
  return Array.isArray(value) ? value.map(textOf).join(isRows ? ";" : ",") : String(value);
}

/** The simulator's request for a flock. `kinds`: what kind of value each field has. */
export function requestOf(flock, kinds) {
  const request = { parameters: {} };
  for (const [name, text] of Object.entries(flock)) {
    if (STRINGS.includes(name)) {
      request[name] = text;
    } else {
      request.parameters[name] = valueFrom(kinds[name], text);
    }
  }
  return request;
}

/** The simulator's requests for the flocks that are shown, one or two. */
export function requestsOf({ flock, beside }, kinds) {
  return [flock, ...(beside ? [{ ...flock, ...beside }] : [])].map((each) => requestOf(each, kinds));
}

const isOwn = (name) => !STRINGS.includes(name);

/** The command that simulates a flock, for so many seconds. */
export function commandLine(flock, seconds) {
  const words = ["flockenv run"];
  if (flock.preset) {
    words.push(`--preset ${flock.preset}`);
  }
  for (const [name, value] of Object.entries(flock).filter(([name]) => isOwn(name))) {
    const isList = value.includes(",") || value.includes(";");
    words.push(`--set ${isList ? `'${name}=${listed(value)}'` : `${name}=${value}`}`);
  }
  const { leaders = "" } = flock;
  words.push(...(leaders ? [`--policy "${leaders}"`] : []), `--seed ${flock.seed ?? 0}`, `--minutes ${seconds / 60}`);
  // A flock whose leaders have policies of their own is no command.
  return leaders.includes(",") ? "" : words.join(" ");
}

/** A list as TOML has it; a row of numbers that ends in a semicolon is one of several. */
function listed(value) {
  if (value.includes(";")) {
    return `[${value.split(";").filter(Boolean).map(listed).join(", ")}]`;
  }
  return `[${value.split(",").join(", ")}]`;
}

/** The same in Python, for one flock or two. `kinds`: what kind of value each field has. */
export function pythonText(flocks, seconds, kinds) {
  return ["import flockenv", ...flocks.map((flock, place) => simulation(flock, seconds, kinds, place > 0 ? "beside" : "recording")), ""].join("\n");
}

function simulation(flock, seconds, kinds, name) {
  const changes = Object.entries(flock).filter(([name]) => isOwn(name))
    .map(([name, value]) => `${name}=${pythonValue(value, kinds[name])}`);
  const { leaders = "" } = flock;
  const each = leaders.split(",").map((name, leader) => `"leader_${leader}": "${name}"`);
  const steering = each.length > 1 ? `{${each.join(", ")}}` : `"${leaders}"`;
  const policy = leaders ? `, policy=${steering}` : "";
  return [
    "",
    `parameters = flockenv.FlockParameters.preset("${flock.preset ?? "simulation"}")${changes.length > 0 ? `.replace(\n    ${changes.join(", ")}\n)` : ""}`,
    `${name} = flockenv.simulate(parameters, seed=${flock.seed ?? 0}, duration_s=${seconds}${policy})`,
  ].join("\n");
}

function pythonValue(text, kind) {
  const number = (each) => (/inf/i.test(each) ? 'float("inf")' : each.trim());
  if (kind === "flag") {
    return text === "true" ? "True" : "False";
  }
  if (kind === "count" || kind === "real") {
    return text;
  }
  if (kind === "rows") {
    return `(${text.split(";").filter(Boolean).map((row) => `(${row.split(",").map(number).join(", ")}), `).join("").trim()})`;
  }
  if (kind === "pool" && text.includes(",")) {
    return `(${text.split(",").map(number).join(", ")})`;
  }
  return text.includes(",") ? `[${text.split(",").map((each) => `"${each}"`).join(", ")}]` : `"${text}"`;
}

/** Parameters as TOML, a line each: what JSON and TOML write alike, and infinity. */
export function tomlOf(values) {
  const line = ([name, value]) => `${name} = ${JSON.stringify(value).replaceAll('"inf"', "inf")}\n`;
  return Object.entries(values).map(line).join("");
}

/** Parameters from TOML as recordings hold it: names with values, and lists over several lines. */
export function valuesOfToml(toml) {
  const assignments = toml.matchAll(/^(\w+)[ \t]*=[ \t]*(\[(?:[^[\]]|\[[^[\]]*\])*\]|[^\n]*)/gm);
  return Object.fromEntries(Array.from(assignments, ([, name, value]) => {
    const json = value.replace(/,(\s*\])/g, "$1").replace(/\+?\binf\b/g, '"inf"').trim();
    try {
      return [name, JSON.parse(json)];
    } catch {
      // Not what it should be, for the simulator to refuse.
      return [name, value.trim()];
    }
  }));
}
