// A run: the recording's numbers at each sample, and interpolated poses for the picture.

export class Run {
  /** `description`: the fields that the run gets; `time`: the time of each sample in s, by default from the column `time_s`. */
  constructor(description, columns, time = timesOf(columns.get("time_s"))) {
    Object.assign(this, description);
    this.columns = columns;
    this.time = time;
    this.length = time.length;
    this.firstContact = this.#firstContacts();
  }

  get hasForces() {
    return this.columns.has("contact_count");
  }

  /** The index of each sample's first contact in the columns of contacts; the last entry is the number of all contacts. */
  #firstContacts() {
    const first = new Int32Array(this.length + 1);
    if (this.columns.has("contact_count")) {
      const count = this.columns.get("contact_count").values;
      for (let k = 0; k < this.length; k += 1) {
        first[k + 1] = first[k] + count[k];
      }
    }
    return first;
  }

  /** The last sample at or before a time. */
  sampleAt(time) {
    let low = 0;
    let high = this.length;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (this.time[middle] <= time + 1e-9) {
        low = middle;
      } else {
        high = middle;
      }
    }
    return low;
  }

  /** The time of the first sample after a time; Infinity without one. */
  timeAfter(time) {
    return this.time.find((sampled) => sampled > time + 1e-9) ?? Infinity;
  }

  /** Poses at a time, [x, y, heading] for each boat, interpolated linearly between samples; NaN for a missing boat. */
  posesAt(time) {
    const sample = this.sampleAt(time);
    const next = Math.min(sample + 1, this.length - 1);
    const interval = this.time[next] - this.time[sample];
    const fraction = interval > 0 ? Math.min(Math.max((time - this.time[sample]) / interval, 0), 1) : 0;
    const position = this.columns.get("position_cm");
    const heading = this.columns.get("heading");
    const between = (column, channel) => {
      const now = column.at(sample, channel);
      return now + fraction * (column.at(next, channel) - now);
    };
    const missing = [NaN, NaN, NaN];
    return Array.from({ length: this.boats }, (_, boat) => this.isPresent(boat, sample) ? [
      between(position, 2 * boat),
      between(position, 2 * boat + 1),
      between(heading, boat),
    ] : missing);
  }

  /** Whether a boat is present at a sample. Only tracked boats come and go: other runs have no such column. */
  isPresent(boat, sample) {
    return this.columns.get("present")?.at(sample, boat) !== 0;
  }

  /** The role of a boat in pictures. An opponent is a leader that leads counter-clockwise while others lead clockwise. */
  roleOf(boat) {
    if (boat >= this.leaders) {
      return "normal";
    }
    return this.targets?.[boat] === "ccw" ? "opponent" : "leader";
  }

  /** A boat's name. */
  nameOf(boat) {
    return this.ids?.[boat] ?? `boat ${boat}`;
  }

  /** Value of a series at a sample; undefined without the series. */
  value(key, sample) {
    return this.columns.get(key)?.at(sample);
  }

  /** Mean of a series up to a sample, in the analysis windows if there are any; undefined without the series. */
  meanUpTo(key, sample) {
    const column = this.columns.get(key);
    if (!column) {
      return undefined;
    }
    this.means ??= new Map();
    if (!this.means.has(key)) {
      const means = new Float64Array(this.length);
      for (let [k, sum, count] = [0, 0, 0]; k < this.length; k += 1) {
        const isCounted = this.phases.length === 0 || this.inWindow(k);
        [sum, count] = isCounted ? [sum + column.at(k), count + 1] : [sum, count];
        means[k] = sum / count;
      }
      this.means.set(key, means);
    }
    return this.means.get(key)[sample];
  }

  phase(sample) {
    return this.phases[this.columns.get("phase").at(sample)];
  }

  inWindow(sample) {
    return this.columns.get("in_analysis_window").at(sample) === 1;
  }

  /** A leader's rudder command at a sample; undefined if it was not recorded. */
  rudder(boat, sample) {
    return boat < this.leaders ? this.columns.get("rudder")?.at(sample, boat) : undefined;
  }

  /** A leader's orientation φ in the local frame, in rad, not wrapped. */
  orientation(boat, sample) {
    return boat < this.leaders ? this.columns.get("leader_phi")?.at(sample, boat) : undefined;
  }

  /** Contacts that carried a force at a sample: boats `i` and `j` (negative for a wall), position along the core of `i` in cm, direction of the push on `i` in rad, force in cm/s². */
  contacts(sample) {
    const contacts = [];
    const column = (name) => this.columns.get(`contact_${name}`);
    for (let k = this.firstContact[sample]; k < this.firstContact[sample + 1]; k += 1) {
      contacts.push({
        i: column("i").at(k),
        j: column("j").at(k),
        along: column("along_cm").at(k),
        angle: column("angle").at(k),
        force: column("force").at(k),
      });
    }
    return contacts;
  }
}

function timesOf(column) {
  return Float64Array.from(column.values, (value) => value * column.quantum);
}

/** First and last time of all runs. */
export function span(runs) {
  return [Math.min(...runs.map((run) => run.time[0])), Math.max(...runs.map((run) => run.time.at(-1)))];
}
