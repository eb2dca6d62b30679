// The simulator for the page: sends questions, receives answers, and starts a new thread if the old
// one does not answer.

/** Time in ms after which the thread of an unanswered question counts as lost. */
const PATIENCE = 15_000;

/** The error if the simulator does not answer; `field` names the parameter at fault, if there is one. */
export class Unanswered extends Error {
  constructor({ words, field = "", refused = false }) {
    super(words);
    Object.assign(this, { field, refused });
  }
}

export class Simulator {
  worker = null;
  next = 0;
  open = new Map();

  /** `script`: the thread's own; `bytes`: the compiled simulator. */
  constructor(script, bytes) {
    this.script = script;
    this.bytes = bytes;
  }

  /** For how many ms the oldest question has been open; 0 if none is. */
  get waiting() {
    const [oldest] = this.open.values();
    return oldest ? performance.now() - oldest.asked : 0;
  }

  /** Ends the thread at once; its open questions fail with this sentence. */
  stop(words) {
    this.worker?.terminate();
    for (const { reject, waited } of this.open.values()) {
      clearTimeout(waited);
      reject(new Unanswered({ words }));
    }
    this.open.clear();
  }

  /** Starts a thread, in place of the present one; returns the simulator's declarations. */
  async start() {
    this.worker?.terminate();
    const address = URL.createObjectURL(new Blob([this.script], { type: "text/javascript" }));
    this.worker = new Worker(address);
    this.worker.addEventListener("message", ({ data }) => this.#answered(data));
    this.worker.addEventListener("error", (event) => this.stop(event.message || "the simulator's thread does not start"));
    const { described } = await this.ask("start", { bytes: this.bytes });
    URL.revokeObjectURL(address);
    return described;
  }

  /** Asks a question; returns the answer, or throws an `Unanswered`. */
  ask(kind, message) {
    return new Promise((resolve, reject) => {
      this.next += 1;
      const id = this.next;
      const waited = setTimeout(() => this.stop("it took too long"), PATIENCE);
      this.open.set(id, { resolve, reject, waited, asked: performance.now() });
      this.worker.postMessage({ id, kind, ...message });
    });
  }

  #answered({ id, said, error }) {
    const question = this.open.get(id);
    if (!question) {
      return;
    }
    this.open.delete(id);
    clearTimeout(question.waited);
    if (error) {
      question.reject(new Unanswered(error));
    } else {
      question.resolve(said);
    }
  }
}
