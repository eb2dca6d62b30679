// A run that grows while it is shown, and drops its oldest samples, so that its memory is bounded.

import { Run } from "../flockenv/replay/shared/run.mjs";
import { CONTACT } from "./core.mjs";

/** Most leaders of a flock on the page. */
export const MOST_LEADERS = 8;
/** Ten minutes, at ten samples per second. */
const KEPT_SAMPLES = 6000;
/** Most numbers in the poses and velocities of a run. */
const KEPT_NUMBERS = 4_000_000;
/** Samples whose contacts are kept. */
const CONTACT_SAMPLES = 40;

/** A series with some numbers per sample, read like the columns of recordings. */
class GrowingColumn {
  constructor(stride, capacity) {
    Object.assign(this, { stride, length: 0, values: new Float64Array(stride * capacity) });
  }

  at(sample, channel = 0) {
    return this.values[sample * this.stride + channel];
  }

  /** Appends samples, of which each has `width` numbers. */
  append(numbers, width = this.stride) {
    const count = width === 0 ? 0 : numbers.length / width;
    if (width === this.stride) {
      this.values.set(numbers, this.length * this.stride);
    } else {
      for (let k = 0; k < count; k += 1) {
        this.values.set(numbers.subarray(k * width, (k + 1) * width), (this.length + k) * this.stride);
      }
    }
    this.length += count;
  }

  forget(samples) {
    this.values.copyWithin(0, samples * this.stride, this.length * this.stride);
    this.length -= samples;
  }

  /** The first `width` numbers of every sample from this one on. */
  from(sample, width = this.stride) {
    const count = this.length - sample;
    const numbers = new Float64Array(count * width);
    for (let k = 0; k < count; k += 1) {
      const start = (sample + k) * this.stride;
      numbers.set(this.values.subarray(start, start + width), k * width);
    }
    return numbers;
  }
}

/** Some channels of another column. */
function view(column, channelOf) {
  return { at: (sample, channel = 0) => column.at(sample, channelOf(channel)) };
}

export class GrowingRun extends Run {
  /** `described`: the description of the run, as in a recording; `series`: the names of the quantities of each sample. */
  constructor(described, series, capacity = Math.min(KEPT_SAMPLES, Math.floor(KEPT_NUMBERS / (6 * described.boats)))) {
    const raw = Object.fromEntries(["time_s", "phase", "in_analysis_window"].map((name) => [name, new GrowingColumn(1, capacity)]));
    raw.pose = new GrowingColumn(3 * described.boats, capacity);
    raw.velocity = new GrowingColumn(3 * described.boats, capacity);
    raw.rudder = new GrowingColumn(Math.max(MOST_LEADERS, described.leaders), capacity);
    raw.series = new GrowingColumn(series.length, capacity);
    super(described, columnsOf(raw, series), raw.time_s.values.subarray(0, 0));
    Object.assign(this, { raw, capacity, statistics: [], latestContacts: [], changedAt: 0 });
    this.restartMeans();
  }

  get hasForces() {
    return !this.isRecorded;
  }

  get end() {
    return this.time.at(-1);
  }

  /** Mean of `psi_o`, `rotation` or `signed_order` in the analysis window since the run, or its last change, started. */
  mean(key) {
    return this.sums[key] / this.counted;
  }

  /** Replaces the parameters. */
  describe(described) {
    Object.assign(this, described, { changedAt: this.end });
    this.restartMeans();
  }

  /** Restarts the means. */
  restartMeans() {
    Object.assign(this, { sums: { psi_o: 0, rotation: 0, signed_order: 0 }, counted: 0, cycleOrder: [0, 0] });
  }

  /** Appends samples of the simulator; `onCycle` gets the mean order of each analysis window that ends. */
  append(taken, onCycle = () => {}) {
    const count = taken.time_s.length;
    if (this.length + count > this.capacity) {
      this.#forget(Math.max(this.length + count - this.capacity, this.capacity >> 1));
    }
    const first = this.length;
    for (const name of ["time_s", "phase", "in_analysis_window", "pose", "velocity", "series"]) {
      this.raw[name].append(taken[name]);
    }
    this.raw.rudder.append(taken.rudder, this.leaders);
    this.raw.rudder.length = this.raw.time_s.length;
    this.length = this.raw.time_s.length;
    this.time = this.raw.time_s.values.subarray(0, this.length);
    for (let k = first; k < this.length; k += 1) {
      this.#score(k, onCycle);
    }
    if (count > 0) {
      this.statistics = taken.statistics;
      this.latestContacts = this.latestContacts.slice(1 - CONTACT_SAMPLES);
      this.latestContacts.push({ time: this.end, numbers: taken.contacts });
    }
  }

  #forget(samples) {
    const forgotten = Math.min(samples, this.length);
    for (const column of Object.values(this.raw)) {
      column.forget(forgotten);
    }
    this.length -= forgotten;
  }

  #score(sample, onCycle) {
    if (this.inWindow(sample)) {
      for (const key of Object.keys(this.sums)) {
        this.sums[key] += this.value(key, sample);
      }
      this.counted += 1;
      this.cycleOrder[0] += this.value("psi_o", sample);
      this.cycleOrder[1] += 1;
    } else if (this.cycleOrder[1] > 0) {
      onCycle(this.cycleOrder[0] / this.cycleOrder[1]);
      this.cycleOrder = [0, 0];
    }
  }

  /** Contacts of the last sample that has them, if it is less than 0.5 s before this one; otherwise none. */
  contacts(sample) {
    const known = this.latestContacts.findLast(({ time }) => time <= this.time[sample] + 1e-9);
    const numbers = known && this.time[sample] - known.time < 0.5 ? known.numbers : [];
    return Array.from({ length: numbers.length / CONTACT }, (_, k) => {
      const [i, j, along, x, y, force] = numbers.subarray(k * CONTACT, (k + 1) * CONTACT);
      return { i, j, along, angle: Math.atan2(y, x), force };
    });
  }
}

function columnsOf(raw, series) {
  const columns = new Map(Object.entries(raw));
  columns.set("position_cm", view(raw.pose, (channel) => 3 * (channel >> 1) + (channel & 1)));
  columns.set("heading", view(raw.pose, (boat) => 3 * boat + 2));
  columns.set("turning_rate", view(raw.velocity, (boat) => 3 * boat + 2));
  columns.set("speed_cm_s", {
    at: (sample, boat) => Math.hypot(raw.velocity.at(sample, 3 * boat), raw.velocity.at(sample, 3 * boat + 1)),
  });
  columns.set("leader_phi", {
    // Clockwise from the outward direction, as the simulator's local frame has it.
    at: (sample, boat) => Math.atan2(raw.pose.at(sample, 3 * boat + 1), raw.pose.at(sample, 3 * boat)) - raw.pose.at(sample, 3 * boat + 2),
  });
  series.forEach((name, index) => {
    columns.set(name, view(raw.series, () => index));
  });
  return columns;
}
