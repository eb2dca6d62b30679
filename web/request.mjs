// What the page shows, as its link has it: parameters by name, a seed, how leaders steer, and a second flock beside.

/** What else than parameters of flocks a link may hold: accepted values, in words and as a test. */
export const OTHER = {
  speed: ["one of 1, 2, 4, 8, 16, 32, 64 and max", (text) => SPEEDS.includes(text)],
  boat: ["the number of a boat", (text) => /^\d{1,3}$/.test(text)],
  forces: ["0 or 1", (text) => /^[01]$/.test(text)],
  lesson: ["a word", (text) => /^[a-z-]{1,20}$/.test(text)],
};
export const SPEEDS = ["1", "2", "4", "8", "16", "32", "64", "max"];
/** What this page shows at most, of fields that may be larger elsewhere. */
const LIMITS = { n_boats: [2, 300], n_leaders: [0, 8], dt_s: [0.001, 1] };
/** Of the second flock: what of it differs from the first. */
const BESIDE = "beside.";
const SHOWN = 40;

const cut = (text) => (text.length > SHOWN ? `${text.slice(0, SHOWN)}…` : text);

/**
 * What a fragment asks for: `flock` and `beside` (null: none) hold parameters by name, `other` the rest, and
 * `ignored` a sentence for each part that cannot be followed.
 */
export function readLink(fragment, fields) {
  const wanted = { flock: {}, beside: null, other: {}, ignored: [] };
  const refuse = (key, text, why) => wanted.ignored.push(`The link's ${cut(key)}=${cut(text)} is ignored: ${why}.`);
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
    } else if (!["preset", "seed", "leaders", ...fields].includes(name) || /[\n\r]/.test(text)) {
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

/** The simulator's requests for the flocks that are shown, one or two. */
export function requestsOf({ flock, beside }) {
  const written = (fields) => Object.entries(fields).map(([name, value]) => `${name}=${value}`).join("\n");
  return [written(flock), ...(beside ? [written({ ...flock, ...beside })] : [])];
}

const isOwn = (name) => !["preset", "seed", "leaders"].includes(name);

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
  const policy = flock.leaders ?? "paper's law at every substep";
  words.push(...(policy === "paper's law at every substep" ? [] : [`--policy "${policy}"`]), `--seed ${flock.seed ?? 0}`, `--minutes ${seconds / 60}`);
  // A flock whose leaders have policies of their own is no command.
  return policy.includes(",") ? "" : words.join(" ");
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
  const { leaders = "paper's law at every substep" } = flock;
  const each = leaders.split(",").map((name, leader) => `"leader_${leader}": "${name}"`);
  const steering = each.length > 1 ? `{${each.join(", ")}}` : `"${leaders}"`;
  const policy = leaders === "paper's law at every substep" ? "" : `, policy=${steering}`;
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

/** The values of parameters as TOML, a line each. */
export function tomlOf(values, kinds) {
  const real = (text) => (/inf/i.test(text) ? "inf" : /[.e]/.test(text) ? text : `${text}.0`);
  const line = (name, text) => {
    const kind = kinds[name];
    const isRadii = kind === "pool" && text.includes(",");
    if (kind === "rows") {
      return `[${text.split(";").filter(Boolean).map((row) => `[${row.split(",").map(real).join(", ")}]`).join(", ")}]`;
    }
    if (kind === "real" || isRadii) {
      return isRadii ? `[${text.split(",").map(real).join(", ")}]` : real(text);
    }
    if (kind === "choices" && text.includes(",")) {
      return `[${text.split(",").map((each) => `"${each}"`).join(", ")}]`;
    }
    return kind === "count" || kind === "flag" ? text : `"${text}"`;
  };
  return Object.entries(values).map(([name, text]) => `${name} = ${line(name, text)}\n`).join("");
}

/** A request from parameters as TOML, as recordings hold them: names with values, and lists over several lines. */
export function requestOfToml(toml) {
  const assignments = toml.matchAll(/^(\w+)[ \t]*=[ \t]*(\[(?:[^[\]]|\[[^[\]]*\])*\]|[^\n]*)/gm);
  return Array.from(assignments, ([, name, value]) => `${name}=${plainValue(value.trim())}`).join("\n");
}

function plainValue(value) {
  const each = (list) => list.split(",").map((item) => item.replace(/["'\s]/g, "")).filter(Boolean).join(",");
  if (!value.startsWith("[")) {
    return each(value);
  }
  const rows = Array.from(value.slice(1).matchAll(/\[([^[\]]*)\]/g), ([, row]) => each(row));
  return rows.length > 0 ? rows.join(";") : each(value.slice(1, -1));
}
