// A run that grows while it is shown, and drops its oldest samples, so that its memory is bounded.

import { Run } from "../flockenv/replay/shared/run.mjs";
import { CONTACT_NUMBERS } from "./core.mjs";

/** Most leaders of a flock on the page. */
export const MOST_LEADERS = 8;
/** Samples that are kept: ten minutes, at ten samples per second. */
const KEPT_SAMPLES = 6000;
/** Most numbers in the poses and velocities of a run. */
const KEPT_NUMBERS = 4_000_000;
/** Number of calls of `append` whose contacts are kept. */
const CONTACT_SAMPLES = 40;

/** A series of `stride` numbers per sample, read like the columns of recordings. */
class GrowingColumn {
  constructor(stride, capacity) {
    Object.assign(this, { stride, length: 0, values: new Float64Array(stride * capacity) });
  }

  at(sample, channel = 0) {
    return this.values[sample * this.stride + channel];
  }

  /** Appends samples that have `width` numbers each, at most `stride`. */
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

  /** Removes the first samples. */
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

/** A column that reads another one; `channelOf` maps its channels to those of the other. */
function view(column, channelOf) {
  return { at: (sample, channel = 0) => column.at(sample, channelOf(channel)) };
}

export class GrowingRun extends Run {
  /** `description`: the description of the run, as in a recording; `series`: the names of the quantities of each sample. */
  constructor(description, series, capacity = Math.min(KEPT_SAMPLES, Math.floor(KEPT_NUMBERS / (6 * description.boats)))) {
    const raw = Object.fromEntries(["time_s", "phase", "in_analysis_window"].map((name) => [name, new GrowingColumn(1, capacity)]));
    raw.pose = new GrowingColumn(3 * description.boats, capacity);
    raw.velocity = new GrowingColumn(3 * description.boats, capacity);
    raw.rudder = new GrowingColumn(Math.max(MOST_LEADERS, description.leaders), capacity);
    raw.series = new GrowingColumn(series.length, capacity);
    super(description, columnsOf(raw, series), raw.time_s.values.subarray(0, 0));
    Object.assign(this, { raw, capacity, statistics: [], latestContacts: [], changedAt: 0, hasOtherLeaders: false });
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

  /** Replaces the description after a change. */
  describe(description) {
    const hasOtherLeaders = description.leaders !== this.leaders || (this.hasOtherLeaders && this.changedAt === this.end);
    Object.assign(this, description, { changedAt: this.end, hasOtherLeaders });
    this.restartMeans();
  }

  /** The first sample since the last change: the state that changed. With other leaders it is the one after: order leaves out leaders. */
  get firstSinceChange() {
    const sample = this.sampleAt(this.changedAt);
    return this.hasOtherLeaders && this.time[sample] <= this.changedAt ? sample + 1 : sample;
  }

  /** Restarts the means. */
  restartMeans() {
    Object.assign(this, { sums: { psi_o: 0, rotation: 0, signed_order: 0 }, counted: 0, windowOrder: { sum: 0, count: 0 } });
  }

  /** Appends the simulator's samples; `onCycle` gets the mean order of each analysis window that ends. */
  append(samples, onCycle = () => {}) {
    const count = samples.time_s.length;
    if (this.length + count > this.capacity) {
      this.#forget(Math.max(this.length + count - this.capacity, this.capacity >> 1));
    }
    const first = this.length;
    for (const name of ["time_s", "phase", "in_analysis_window", "pose", "velocity", "series"]) {
      this.raw[name].append(samples[name]);
    }
    this.raw.rudder.append(samples.rudder, this.leaders);
    this.raw.rudder.length = this.raw.time_s.length;
    this.length = this.raw.time_s.length;
    this.time = this.raw.time_s.values.subarray(0, this.length);
    for (let k = first; k < this.length; k += 1) {
      this.#score(k, onCycle);
    }
    if (count > 0) {
      this.statistics = samples.statistics;
      this.latestContacts = this.latestContacts.slice(1 - CONTACT_SAMPLES);
      this.latestContacts.push({ time: this.end, numbers: samples.contacts });
    }
  }

  #forget(samples) {
    const forgotten = Math.min(samples, this.length);
    for (const column of Object.values(this.raw)) {
      column.forget(forgotten);
    }
    this.length -= forgotten;
  }

  /** Adds a sample to the means if it is in the analysis window; reports the mean order of a window that has ended. */
  #score(sample, onCycle) {
    if (this.inWindow(sample)) {
      for (const key of Object.keys(this.sums)) {
        this.sums[key] += this.value(key, sample);
      }
      this.counted += 1;
      this.windowOrder.sum += this.value("psi_o", sample);
      this.windowOrder.count += 1;
    } else if (this.windowOrder.count > 0) {
      onCycle(this.windowOrder.sum / this.windowOrder.count);
      this.windowOrder = { sum: 0, count: 0 };
    }
  }

  /** The latest contacts up to a sample, if they are less than 0.5 s older. */
  contacts(sample) {
    const latest = this.latestContacts.findLast(({ time }) => time <= this.time[sample] + 1e-9);
    const numbers = latest && this.time[sample] - latest.time < 0.5 ? latest.numbers : [];
    return Array.from({ length: numbers.length / CONTACT_NUMBERS }, (_, k) => {
      const [i, j, along, x, y, force] = numbers.subarray(k * CONTACT_NUMBERS, (k + 1) * CONTACT_NUMBERS);
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
    // Clockwise from the outward direction, as in the simulator's local frame.
    at: (sample, boat) => Math.atan2(raw.pose.at(sample, 3 * boat + 1), raw.pose.at(sample, 3 * boat)) - raw.pose.at(sample, 3 * boat + 2),
  });
  series.forEach((name, index) => {
    columns.set(name, view(raw.series, () => index));
  });
  return columns;
}
