// The compiled simulator behind functions: JSON to flocks, JSON and numbers back.

/** Names of the columns that a flock fills, in their order. */
export const COLUMNS = ["time_s", "phase", "in_analysis_window", "pose", "velocity", "rudder", "series",
  "statistics", "contacts", "observation"];
/** Numbers of a contact: two boats (−1 for a wall), position along the core, direction as a vector, force. */
export const CONTACT = 6;

/** The longest sentence, in letters: values may have hundreds of digits. */
const LONGEST_SENTENCE = 250;

/** An error for a request that the simulator refuses, with the parameter at fault, if there is one, and a sentence. */
export class Refusal extends Error {
  constructor({ field, words }) {
    super(words.length > LONGEST_SENTENCE ? `${words.slice(0, LONGEST_SENTENCE)}…` : words);
    this.field = field;
  }
}

export class Core {
  constructor(exports) {
    this.exports = exports;
  }

  static async load(bytes) {
    const { instance } = await WebAssembly.instantiate(bytes, {});
    return new Core(instance.exports);
  }

  /** Bytes of the simulator's memory. */
  get memory() {
    return this.exports.memory.buffer.byteLength;
  }

  /** The core's declarations: fields, quantities … */
  describe() {
    this.exports.describe();
    return this.#answer();
  }

  /** All parameters of a request; no flock starts. */
  check(request) {
    return this.#ask(request, () => this.exports.check());
  }

  /** The recorded quantities, null if undefined, of the flock that was checked last, in a given state (`pose`, `velocity`). */
  recorded(state) {
    return this.#ask(state, () => this.exports.recorded());
  }

  /** Restarts a flock; returns its parameters. */
  open(flock, request) {
    return this.#ask(request, () => this.exports.open(flock));
  }

  /** Changes a flock; returns how it continued, and its parameters. */
  change(flock, request) {
    return this.#ask(request, () => this.exports.change(flock));
  }

  close(flock) {
    this.exports.close(flock);
  }

  /** Sets the heading that the visitor chose. */
  steer(flock, heading) {
    this.#done(this.exports.steer(flock, heading));
  }

  /** Takes up to `samples` samples within `work`, in substeps times boats; returns their number. */
  advance(flock, samples, work) {
    const taken = this.exports.advance(flock, samples, work);
    this.#done(taken >= 0);
    return taken;
  }

  /** Fills the columns of contacts and of a boat's observation, as they are now. */
  look(flock, boat) {
    this.#done(this.exports.look(flock, boat));
  }

  /** Starts a training; returns its progress and its policy. */
  train(asked) {
    return this.#ask(asked, () => this.exports.train());
  }

  /** Takes a number of branches of the training; returns what `train` does. */
  learn(branches) {
    this.#done(this.exports.learn(branches));
    return this.#answer();
  }

  /** The derived quantity at this index of the table, for a given order, its angle and the target's sign. */
  derived(index, order, angle, sign) {
    return this.exports.derived(index, order, angle, sign);
  }

  /** The columns since the last call, by name. */
  take(flock) {
    const taken = COLUMNS.map((name, index) => {
      const [start, length] = [this.exports.column(flock, index), this.exports.column_length(flock, index)];
      return [name, new Float64Array(this.exports.memory.buffer, length > 0 ? start : 0, length).slice()];
    });
    this.exports.take(flock);
    return Object.fromEntries(taken);
  }

  #ask(request, call) {
    const bytes = new TextEncoder().encode(JSON.stringify(request));
    const start = this.exports.input(bytes.length);
    new Uint8Array(this.exports.memory.buffer, start, bytes.length).set(bytes);
    this.#done(call());
    return this.#answer();
  }

  #done(isDone) {
    if (!isDone) {
      throw new Refusal(this.#answer());
    }
  }

  #answer() {
    const [start, length] = [this.exports.text(), this.exports.text_length()];
    return JSON.parse(new TextDecoder().decode(new Uint8Array(this.exports.memory.buffer, start, length)));
  }
}
