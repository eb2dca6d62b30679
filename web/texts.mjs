// A flock as a command and in Python.

import { isParameter } from "./request.mjs";

/** Fields that the command has options for. */
const OPTIONS = { n_boats: "--n-boats", n_leaders: "--n-leaders", pool: "--pool", bw_s: "--bw-s" };
const shellWord = (text) => (/^[\w.:=+-]+$/.test(text) ? text : `'${text}'`);
/** A number as TOML and Python write it: in links it may be .5 or 007. Other text stays. */
const spelled = (text) => (text.trim() !== "" && Number.isFinite(Number(text)) ? String(Number(text)) : text.trim());

/** Whether commands and Python can express these changes. */
export function isSchedule(changes) {
  const isFixed = (name) => !isParameter(name) || name === "n_leaders";
  return changes.every(({ fields }) => Object.entries(fields).every(([name, value]) => value !== "" && !isFixed(name)));
}

/** Options of a command for a flock's parameters. */
function fieldWords(flock) {
  return Object.entries(flock).filter(([name]) => isParameter(name)).map(([name, value]) => {
    const option = OPTIONS[name];
    return option ? `${option} ${shellWord(tomlValue(value).replace("[", "(").replace("]", ")"))}` : `--set ${shellWord(`${name}=${tomlValue(value)}`)}`;
  });
}

/** The command that repeats a training with these settings; empty unless the flock has the preset "simulation". `values`: values of all parameters. */
export function trainingCommand({ preset = "simulation", ...flock }, values, { flock_hours: hours, ...settings }, seed) {
  const optionValues = Object.fromEntries(Object.keys(OPTIONS).map((name) => [name, values[name]]));
  const set = Object.entries({ action_mode: "rudder", ...settings }).map(([name, value]) => `--set ${name}=${value}`);
  const words = [...fieldWords({ ...optionValues, ...flock }), `--seed ${seed}`, `--flock-hours ${hours}`, ...set];
  return preset === "simulation" ? `flockenv train --algorithm branches ${words.join(" ")}` : "";
}

/** The command that simulates a flock for a number of seconds, with its changes; empty if leaders have different policies. */
export function commandLine(flock, seconds, changes = []) {
  const words = ["flockenv run", ...(flock.preset ? [`--preset ${flock.preset}`] : []), ...fieldWords(flock)];
  const { leaders = "" } = flock;
  words.push(...(leaders ? [`--policy "${leaders}"`] : []), `--seed ${flock.seed ?? 0}`, `--minutes ${seconds / 60}`);
  for (const { time, fields } of changes) {
    words.push(...Object.entries(fields).map(([name, value]) =>
      `--at ${shellWord(`${time}:${name}=${tomlValue(value)}`)}`));
  }
  return leaders.includes(",") ? "" : words.join(" ");
}

/** A number, word or list in TOML, from its text in links; words have no quotes. */
function tomlValue(value) {
  if (value.includes(";")) {
    return `[${value.split(";").filter(Boolean).map(tomlValue).join(", ")}]`;
  }
  return value.includes(",") ? `[${value.split(",").map(spelled).join(", ")}]` : spelled(value);
}

/** Python that simulates flocks for a number of seconds, with their changes. `kinds`: the kind of each field's value. */
export function pythonText(flocks, seconds, kinds, changes = []) {
  const names = ["recording", "beside"];
  const texts = flocks.map((flock, index) => simulation(flock, seconds, kinds, changes, names[index] ?? `recording_${index + 1}`));
  return ["import flockenv", ...texts, ""].join("\n");
}

function simulation(flock, seconds, kinds, changes, name) {
  const pythonFields = (fields) => Object.entries(fields).filter(([name]) => isParameter(name)).map(([name, value]) => [name, pythonValue(value, kinds[name])]);
  const fields = pythonFields(flock).map(([name, value]) => `${name}=${value}`);
  const { leaders = "" } = flock;
  const policies = leaders.split(",").map((name, leader) => `"leader_${leader}": "${name}"`);
  const steering = policies.length > 1 ? `{${policies.join(", ")}}` : `"${leaders}"`;
  const policy = leaders ? `, policy=${steering}` : "";
  const entries = changes.map(({ time, fields }) => `(${time}, {${pythonFields(fields).map(([name, value]) => `"${name}": ${value}`).join(", ")}})`);
  const schedule = entries.length > 0 ? `,\n    schedule=[${entries.join(", ")}],\n` : "";
  return [
    "",
    `parameters = flockenv.FlockParameters.preset("${flock.preset ?? "simulation"}")${fields.length > 0 ? `.replace(\n    ${fields.join(", ")}\n)` : ""}`,
    `${name} = flockenv.simulate(${schedule ? "\n    " : ""}parameters, seed=${flock.seed ?? 0}, duration_s=${seconds}${policy}${schedule})`,
  ].join("\n");
}

function pythonValue(text, kind) {
  const number = (item) => (/inf/i.test(item) ? 'float("inf")' : spelled(item));
  if (kind === "flag") {
    return text === "true" ? "True" : "False";
  }
  if (kind === "count" || kind === "real") {
    return spelled(text);
  }
  if (kind === "rows") {
    return `(${text.split(";").filter(Boolean).map((row) => `(${row.split(",").map(number).join(", ")}), `).join("").trim()})`;
  }
  if (kind === "pool" && text.includes(",")) {
    return `(${text.split(",").map(number).join(", ")})`;
  }
  return text.includes(",") ? `[${text.split(",").map((item) => `"${item.trim()}"`).join(", ")}]` : `"${text}"`;
}
