// Checks of a recording's arrays. They refuse the same files as flockenv.Recording.load, with the
// same sentences (flockenv/recording/checks.py and stored.py; tests/web/test_damaged_recordings.py
// compares the two).

const TIMES = ["time_s", "phase", "in_analysis_window"];
const TEXTS = ["format", "version", "parameters", "policy"];
const CONTACTS = ["count", "i", "j", "normal", "force", "point_cm", "along_cm"];
/** Bounds of a flock's poses and velocities. */
const WITHIN_REACH = [-1e9, 1e9];
const [REALS, DOUBLES] = [["<f8", "<f4"], ["<f8"]];
/** NumPy's names of dtypes, by their codes in files. Texts have the code as their name. */
const NUMPY_NAMES = { "<f8": "float64", "<f4": "float32", "<i8": "int64", "<i4": "int32", "<u8": "uint64", "<u4": "uint32", "|b1": "bool", "|u1": "uint8" };

const dtypeName = (descr) => NUMPY_NAMES[descr] ?? descr;
const tuple = (shape) => (shape.length === 1 ? `(${shape[0]},)` : `(${shape.join(", ")})`);
const isSame = (shape, other) => shape.length === other.length && shape.every((size, k) => size === other[k]);
/** A bound as Python's format `g` writes it: 1e+09 or 3.14159. */
const formatBound = (bound) => (Math.abs(bound) < 1e6 ? `${Number(bound.toPrecision(6))}` : bound.toExponential().replace(/\+(\d)$/, "+0$1"));
const quoted = (text) => `'${text}'`;

function refuse(sentence) {
  throw new Error(sentence);
}

/**
 * Checks an array's dtype, shape and values. `isUndefined`: all numbers must be NaN; `hasGaps`: numbers may be NaN, for a missing boat all of
 * them; otherwise they must be finite.
 */
function checkArray(name, array, shape, descrs, { isUndefined = false, hasGaps = false, bounds } = {}) {
  if (!descrs.includes(array.descr)) {
    refuse(`${name} is of ${dtypeName(array.descr)}, expected an array of ${dtypeName(descrs[0])}`);
  }
  if (!isSame(array.shape, shape)) {
    refuse(`${name} has shape ${tuple(array.shape)}, expected ${tuple(shape)}`);
  }
  if (!array.descr.startsWith("<f")) {
    return;
  }
  if (hasGaps) {
    const width = shape.length === 3 ? shape[2] : 1;
    const isConsistent = array.values.every((value, k) => Number.isNaN(value) === Number.isNaN(array.values[k - (k % width)]));
    if (!isConsistent || array.values.some((value) => Math.abs(value) === Infinity)) {
      refuse(`${name} must be finite, except for missing boats`);
    }
  } else if (!array.values.every(isUndefined ? Number.isNaN : Number.isFinite)) {
    refuse(`${name} must be ${isUndefined ? "undefined (NaN)" : "finite"}`);
  }
  const [low, high] = bounds ?? [-Infinity, Infinity];
  // Means are sums with rounding errors, so bounds have a margin.
  if (array.values.some((value) => value < low - 1e-6 || value > high + 1e-6)) {
    refuse(`${name} must be within ${formatBound(low)} and ${formatBound(high)}`);
  }
}

function checkTimes({ time_s: time, duration_s: duration }) {
  const [times, [end]] = [time.values, duration.values];
  const isRising = times.every((value, k) => k === 0 || value > times[k - 1]);
  const [first, last] = [times[0] ?? 0, times.at(-1) ?? 0];
  // Times are rounded to a nanosecond, so the last one may exceed the duration by that.
  if (!isRising || first < 0 || last > end + 1e-9 || !(end + 1e-9 >= 0 && end <= 1e9)) {
    refuse("time_s must increase from 0 on, not beyond duration_s, at most 1e9 s, and hold at least one time if duration_s is not given");
  }
}

function checkIds(ids, boats) {
  if (!ids.descr.startsWith("<U") || !isSame(ids.shape, [boats])) {
    refuse(`ids must be an array of str of shape (${boats},)`);
  }
  if (new Set(ids.values).size !== boats) {
    refuse("ids must differ from each other");
  }
}

/** Checks the quantities that a user added. */
function checkUserQuantities(arrays, samples, quantities) {
  const reservedNames = new Set([...quantities.map(({ key }) => key), ...TIMES, "boat", "id", "is_leader"]);
  for (const [stored, array] of Object.entries(arrays).filter(([name]) => name.startsWith("quantity_"))) {
    const name = stored.slice("quantity_".length);
    if (!/^[\p{ID_Start}_]\p{ID_Continue}*$/u.test(name) || reservedNames.has(name)) {
      refuse(`quantity ${quoted(name)} is not accepted: an identifier that no quantity or column of recordings has`);
    }
    if (array.descr !== "<f8") {
      refuse(`quantity ${quoted(name)} must be an array of float64`);
    }
    if (!isSame(array.shape, [samples])) {
      refuse(`quantity ${quoted(name)} has shape ${tuple(array.shape)}, expected ${tuple([samples])}`);
    }
  }
}

function checkContacts(contacts, samples, { n_boats: boats, ...others }) {
  const total = contacts.i.shape[0] ?? 0;
  const shapes = { count: [samples], normal: [total, 2], point_cm: [total, 2] };
  const descrs = { count: "<i8", i: "<i4", j: "<i4" };
  for (const name of CONTACTS) {
    const [shape, descr] = [shapes[name] ?? [total], descrs[name] ?? "<f4"];
    if (contacts[name].descr !== descr || !isSame(contacts[name].shape, shape)) {
      refuse(`contacts.${name} must be an array of ${dtypeName(descr)}, shape ${tuple(shape)}`);
    }
    if (!contacts[name].values.every(Number.isFinite)) {
      refuse(`contacts.${name} must be finite`);
    }
  }
  const count = contacts.count.values;
  if (count.some((number) => number < 0 || number > total) || count.reduce((sum, number) => sum + number, 0) !== total) {
    refuse(`contacts.count must add up to the ${total} contacts there are`);
  }
  const [first, second] = [contacts.i.values, contacts.j.values];
  // Only obstacles are parameters that are lists of lists.
  const obstacles = Object.values(others).flat().filter(Array.isArray).length;
  const isBoat = (boat) => boat >= -2 - obstacles && boat < boats;
  if (!first.every((boat) => boat >= 0 && isBoat(boat)) || !second.every(isBoat)) {
    refuse(`contacts.i and contacts.j must be among ${boats} boats`);
  }
  if (!contacts.force.values.every((force) => force > 0)) {
    refuse("contacts.force must be positive");
  }
}

function checkStatistics(arrays, names) {
  if (!names.every((name) => Object.hasOwn(arrays, name))) {
    return;
  }
  const invalid = names.find((name) => arrays[name].shape.length > 0 || !/^<[fiu]|^[|]u1/.test(arrays[name].descr));
  if (invalid) {
    refuse(`${invalid} must be one number`);
  }
}

/** Checks the format, and that no array is missing; returns whether the recording has contacts. */
function checkStored(arrays, format) {
  const storedFormat = arrays.format?.values[0];
  if (storedFormat !== undefined && storedFormat !== format) {
    refuse(`format = ${quoted(storedFormat)} is not accepted: ${quoted(format)}`);
  }
  const contacts = CONTACTS.map((name) => `contacts_${name}`);
  const hasContacts = contacts.some((name) => Object.hasOwn(arrays, name));
  const needed = [...TIMES, "pose", "velocity", ...TEXTS, "seed", "duration_s", ...(hasContacts ? contacts : [])];
  const missing = needed.filter((name) => !Object.hasOwn(arrays, name));
  if (missing.length > 0) {
    refuse(`these arrays are missing: ${missing.join(", ")}`);
  }
  if (TEXTS.some((name) => arrays[name].shape.length > 0 || !arrays[name].descr.startsWith("<U"))) {
    refuse(`${TEXTS.join(", ")} must each be one string`);
  }
  checkArray("seed", arrays.seed, [], ["<u8"]);
  checkArray("duration_s", arrays.duration_s, [], DOUBLES);
  return hasContacts;
}

/** Checks what only some recordings have: the seed of other noise, the rate of an environment's steps, and digests. */
function checkOrigin({ noise_seed: noise, control_hz: rate, start_sha256: start, schedule_sha256: schedule }) {
  const parts = [["noise_seed", noise, /^<u|^[|]u1/, "uint64"], ["control_hz", rate, /^<f/, "float64"],
    ["start_sha256", start, /^<U/, "str"], ["schedule_sha256", schedule, /^<U/, "str"]].filter(([, array]) => array);
  const ofOtherKind = parts.find(([, { shape, descr }, kind]) => shape.length > 0 || !kind.test(descr));
  if (ofOtherKind) {
    refuse(`${ofOtherKind[0]} must be one ${ofOtherKind[3]}`);
  }
  const hertz = rate?.values[0] ?? 1;
  if (!(hertz > 0 && hertz < Infinity)) {
    refuse(`control_hz = ${Number.isInteger(hertz) ? hertz.toFixed(1) : String(hertz).toLowerCase().replace("inity", "")} is not accepted: a positive rate`);
  }
  for (const [name, { values: [text] }] of parts.filter(([, { descr }]) => descr.startsWith("<U"))) {
    if (!/^[0-9a-f]{64}$/.test(text)) {
      refuse(`${name} = ${quoted(text)} is not accepted: a SHA-256 of 64 hexadecimal digits`);
    }
  }
}

function checkRudder(rudder, shape) {
  checkArray("rudder", rudder, shape, DOUBLES);
  if (rudder.values.some((command) => Math.abs(command) > 1)) {
    refuse("rudder must be within [-1, 1]");
  }
}

/**
 * Throws an error unless the arrays form a recording of this `format`. `read` checks the recording's parameters (TOML); its answer is
 * returned. `phases`, `quantities` and `statistics` are those of the simulator.
 */
export async function checkRecording(arrays, { format, phases, quantities, statistics }, read) {
  const hasContacts = checkStored(arrays, format);
  const answer = await read(arrays.parameters.values[0]);
  checkStatistics(arrays, statistics.map(({ name }) => `statistics_${name}`));
  checkOrigin(arrays);
  const { parameters } = answer;
  const { n_boats: boats, n_leaders: leaders } = parameters;
  const [samples] = arrays.time_s.shape;
  const times = samples === undefined ? [] : [samples];
  const isTracked = Object.hasOwn(arrays, "ids");
  const state = [...times, arrays.pose.shape[1] === 0 ? 0 : boats, 3];
  checkArray("time_s", arrays.time_s, times, DOUBLES);
  checkArray("phase", arrays.phase, times, [`<U${Math.max(...phases.map((name) => name.length))}`]);
  checkArray("in_analysis_window", arrays.in_analysis_window, times, ["|b1"]);
  checkArray("pose", arrays.pose, state, REALS, { hasGaps: isTracked, bounds: WITHIN_REACH });
  checkArray("velocity", arrays.velocity, state, [arrays.pose.descr], { hasGaps: isTracked, bounds: WITHIN_REACH });
  if (isTracked) {
    checkIds(arrays.ids, boats);
  }
  if (!arrays.phase.values.every((name) => phases.includes(name) || (isTracked && name === ""))) {
    refuse(`phase holds other names than ${phases.join(", ")}`);
  }
  checkTimes(arrays);
  for (const { key, least_boats: least, range: bounds } of quantities.filter(({ kind }) => kind === "recorded")) {
    const values = arrays[`order_${key}`];
    if (values) {
      const isUndefined = boats - leaders < least || (state[1] === 0 && values.values.every?.(Number.isNaN));
      checkArray(`order.${key}`, values, times, DOUBLES, { bounds, ...(isTracked ? { hasGaps: true } : { isUndefined }) });
    }
  }
  checkUserQuantities(arrays, samples, quantities);
  if (arrays.rudder) {
    checkRudder(arrays.rudder, [...times, leaders]);
  }
  if (hasContacts) {
    checkContacts(Object.fromEntries(CONTACTS.map((name) => [name, arrays[`contacts_${name}`]])), samples, parameters);
  }
  return answer;
}
