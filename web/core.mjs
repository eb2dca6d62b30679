// Calls of the compiled simulator: requests as JSON, answers as JSON or as columns of numbers.

/** Names of the columns that a flock fills, in their order. */
export const COLUMNS = ["time_s", "phase", "in_analysis_window", "pose", "velocity", "rudder", "series",
  "statistics", "contacts", "observation"];
/** How many numbers a contact has: two boats (−1 for a wall), position along the core, direction as a vector, force. */
export const CONTACT_NUMBERS = 6;

/** The longest sentence of an error, in letters. Values in it may have hundreds of digits. */
const LONGEST_SENTENCE = 250;

/** A request that the simulator refuses: `field` is the parameter at fault, if there is one. */
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

  /** Checks a request, and returns all its parameters; no flock starts. */
  check(request) {
    return this.#ask(request, () => this.exports.check());
  }

  /** The recorded quantities in a state (`pose`, `velocity`) of the flock that was checked last; null for an undefined quantity. */
  recorded(state) {
    return this.#ask(state, () => this.exports.recorded());
  }

  /** Restarts a flock; returns its parameters. */
  open(flock, request) {
    return this.#ask(request, () => this.exports.open(flock));
  }

  /** Changes a flock; returns whether it `continued` from its state, and its parameters. */
  change(flock, request) {
    return this.#ask(request, () => this.exports.change(flock));
  }

  close(flock) {
    this.exports.close(flock);
  }

  /** Sets the heading that the visitor chose. */
  steer(flock, heading) {
    this.#checkDone(this.exports.steer(flock, heading));
  }

  /** Takes up to `samples` samples within `work`, in substeps times boats; returns their number. */
  advance(flock, samples, work) {
    const taken = this.exports.advance(flock, samples, work);
    this.#checkDone(taken >= 0);
    return taken;
  }

  /** Fills the columns of contacts and of a boat's observation, as they are now. */
  look(flock, boat) {
    this.#checkDone(this.exports.look(flock, boat));
  }

  /** Starts a training; returns its progress and its policy. */
  train(request) {
    return this.#ask(request, () => this.exports.train());
  }

  /** Simulates a number of branches of the training; returns its progress and its policy. */
  learn(branches) {
    this.#checkDone(this.exports.learn(branches));
    return this.#answer();
  }

  /** The quantity at this index of the table from the order, its angle in rad and the target's sign; NaN if it depends on more. */
  derived(index, order, angle, sign) {
    return this.exports.derived(index, order, angle, sign);
  }

  /** The columns that were filled since the last call, by name. */
  take(flock) {
    const taken = COLUMNS.map((name, index) => {
      const [start, length] = [this.exports.column(flock, index), this.exports.column_length(flock, index)];
      return [name, new Float64Array(this.exports.memory.buffer, length > 0 ? start : 0, length).slice()];
    });
    this.exports.take(flock);
    return Object.fromEntries(taken);
  }

  /** Passes a request, makes a call, and returns its answer. */
  #ask(request, call) {
    const bytes = new TextEncoder().encode(JSON.stringify(request));
    const start = this.exports.input(bytes.length);
    new Uint8Array(this.exports.memory.buffer, start, bytes.length).set(bytes);
    this.#checkDone(call());
    return this.#answer();
  }

  /** Throws the simulator's refusal if a call has failed. */
  #checkDone(isDone) {
    if (!isDone) {
      throw new Refusal(this.#answer());
    }
  }

  #answer() {
    const [start, length] = [this.exports.text(), this.exports.text_length()];
    return JSON.parse(new TextDecoder().decode(new Uint8Array(this.exports.memory.buffer, start, length)));
  }
}
