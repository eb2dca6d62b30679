// Links as requests: parameters by name, a seed, the leaders' steering, and a second flock beside
// the first.

import { ignoredPart } from "../flockenv/replay/shared/link.mjs";
import { LESSONS } from "./lessons.mjs";

/** Largest time of a link, in s. */
export const LATEST = 7200;
const isTime = (text) => /^\d{1,4}(?:\.\d)?$/.test(text) && Number(text) <= LATEST;
/** Parts of a link besides parameters: the accepted values in words, and a function that accepts a value. */
export const OTHER = {
  speed: ["one of 1, 2, 4, 8, 16, 32, 64 and max", (text) => SPEEDS.includes(text)],
  boat: ["the number of a boat", (text) => /^\d{1,3}$/.test(text)],
  forces: ["0 or 1", (text) => /^[01]$/.test(text)],
  colors: ["direction or role", (text) => ["direction", "role"].includes(text)],
  start: [`a number of seconds up to ${LATEST}`, isTime],
  now: [`a number of seconds up to ${LATEST}`, isTime],
  paused: ["0 or 1", (text) => /^[01]$/.test(text)],
  flocks: ["1, 2 or 3", (text) => /^[123]$/.test(text)],
  lesson: [`one of ${LESSONS.map(({ name }) => name).join(", ")}`, (text) => LESSONS.some(({ name }) => name === text)],
};
export const SPEEDS = ["1", "2", "4", "8", "16", "32", "64", "max"];
/** Ranges of fields on this page; the simulator accepts larger ones. */
const LIMITS = { n_boats: [2, 300], n_leaders: [0, 8], dt_s: [0.001, 1] };
/** Fields of a request that are not parameters. */
const STRINGS = ["preset", "seed", "leaders"];
/** Prefix of the fields in which the second flock differs from the first. */
const BESIDE = "beside.";
/** The name of a change during the run: its time in s, and the field that changes. An empty value means the preset's value. */
const CHANGE = /^at\.(\d{1,4}(?:\.\d)?)\.(.+)$/;

/**
 * Reads a fragment. Returns `flock` and `beside` (null: no second flock), parameters by name; `changes`, the changes during the
 * run; `other`, the parts of `OTHER`; and `ignored`, a sentence for each part that cannot be followed.
 */
export function readLink(fragment, fields) {
  const wanted = { flock: {}, beside: null, changes: [], other: {}, ignored: [] };
  const refuse = (key, text, why) => wanted.ignored.push(ignoredPart(key, text, why));
  for (const [key, text] of new URLSearchParams(fragment.replace(/^#/, ""))) {
    const isBeside = key.startsWith(BESIDE);
    const [, time, changed] = CHANGE.exec(key) ?? [];
    const name = changed ?? (isBeside ? key.slice(BESIDE.length) : key);
    if (name === key && Object.hasOwn(OTHER, name)) {
      const [words, isAccepted] = OTHER[name];
      if (isAccepted(text)) {
        wanted.other[name] = text;
      } else {
        refuse(key, text, `${name} is ${words}`);
      }
    } else if (![...STRINGS, ...fields].includes(name) || /[\n\r]/.test(text)) {
      refuse(key, text, "this page knows no such parameter");
    } else if (time !== undefined && !isTime(time)) {
      refuse(key, text, `a change comes by ${LATEST} s`);
    } else if (Object.hasOwn(LIMITS, name) && !isWithin(LIMITS[name], text) && !(changed && text === "")) {
      refuse(key, text, `${name} is ${LIMITS[name].join(" to ")} on this page`);
    } else if (changed) {
      wanted.changes = withChange(wanted.changes, Number(time), { [name]: text });
    } else if (isBeside) {
      wanted.beside = { ...wanted.beside, [name]: text };
    } else {
      wanted.flock[name] = text;
    }
  }
  return wanted;
}

/** Adds a change to a list in order of time; changes at the same time are merged. */
export function withChange(changes, time, fields) {
  const earlier = changes.filter((change) => change.time < time);
  const later = changes.filter((change) => change.time > time);
  const same = changes.find((change) => change.time === time);
  return [...earlier, { time, fields: { ...same?.fields, ...fields } }, ...later];
}

/** The fields in which a flock differs after a change; a field that was removed is empty. */
export function differences(before, after) {
  const names = new Set([...Object.keys(before), ...Object.keys(after)]);
  return Object.fromEntries([...names].filter((name) => before[name] !== after[name]).map((name) => [name, after[name] ?? ""]));
}

/** The fields of a flock after a change; an empty field is removed. */
export function changedFlock(flock, fields) {
  return Object.fromEntries(Object.entries({ ...flock, ...fields }).filter(([, value]) => value !== ""));
}

function isWithin([low, high], text) {
  const value = text.trim() === "" ? NaN : Number(text);
  return value >= low && value <= high;
}

/** The fragment for flocks, their changes during the run, and the other parts of a link. */
export function linkTo({ flock, beside, changes = [], other }) {
  const pairs = [...Object.entries(flock), ...Object.entries(beside ?? {}).map(([name, value]) => [BESIDE + name, value]),
    ...changes.flatMap(({ time, fields }) => Object.entries(fields).map(([name, value]) => [`at.${time}.${name}`, value])),
    ...Object.entries(other)];
  return `#${new URLSearchParams(pairs).toString().replaceAll("%2C", ",").replaceAll("%3B", ";")}`;
}

/** A field's value for JSON, from its text in links: commas separate a list, and semicolons end rows. */
export function valueFrom(kind, text) {
  // Text that is not a number stays text, which the simulator refuses.
  const number = (item) => (item.trim() !== "" && Number.isFinite(Number(item)) ? Number(item) : item.trim());
  const list = (items, read) => items.split(",").filter((item) => item.trim() !== "").map(read);
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

/** The text of a value in links. */
export function textOf(value) {
  const isRows = Array.isArray(value) && Array.isArray(value[0]);
  return Array.isArray(value) ? value.map(textOf).join(isRows ? ";" : ",") : String(value);
}

/** The simulator's request for a flock. `kinds`: the kind of each field's value. */
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

/** The simulator's requests for all flocks: one for each seed, then those of the second kind. */
export function requestsOf({ flock, beside, copies = 1 }, kinds) {
  const flocks = [flock, ...(beside ? [{ ...flock, ...beside }] : [])];
  return flocks.flatMap((fields) => Array.from({ length: copies }, (_, copy) => requestOf({ ...fields, ...seedOf(fields, copy) }, kinds)));
}

/** The field `seed` of a copy of a flock, unless it is that of the flock. A seed that is not a number is kept, and the simulator refuses it. */
function seedOf({ seed = "0" }, copy) {
  return copy > 0 && /^\d+$/.test(seed) ? { seed: String(BigInt(seed) + BigInt(copy)) } : {};
}

/** Whether a field of a flock is one of its parameters. */
export const isParameter = (name) => !STRINGS.includes(name);

/** Parameters as TOML, one per line. JSON and TOML write their values alike, except for infinity. */
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
      // The simulator refuses it.
      return [name, value.trim()];
    }
  }));
}
