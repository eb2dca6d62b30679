// The simulator's thread as the page sees it: questions, answers, and a new thread if the old one does not answer.

/** Time in ms after which a thread that does not answer is ended. */
const PATIENCE = 15_000;

/** A question that fails: the simulator refused it (`refused`), or its thread ended. `field`: the parameter at fault, if there is one. */
export class Unanswered extends Error {
  constructor({ words, field = "", refused = false }) {
    super(words);
    Object.assign(this, { field, refused });
  }
}

export class Simulator {
  /** The thread; null before the start and after a stop. */
  worker = null;
  lastId = 0;
  /** Questions without an answer, by their number. */
  open = new Map();

  /** `script`: source of the thread; `bytes`: the compiled simulator. */
  constructor(script, bytes) {
    this.script = script;
    this.bytes = bytes;
  }

  /** For how many ms the oldest question has been open; 0 if none is. */
  get waiting() {
    const [oldest] = this.open.values();
    return oldest ? performance.now() - oldest.askedAt : 0;
  }

  /** Ends the thread at once; its open questions fail with this sentence. */
  stop(words) {
    this.worker?.terminate();
    this.worker = null;
    for (const { reject, timeout } of this.open.values()) {
      clearTimeout(timeout);
      reject(new Unanswered({ words }));
    }
    this.open.clear();
  }

  /** Starts a thread, in place of the present one; returns the simulator's declarations. */
  async start() {
    this.worker?.terminate();
    const address = URL.createObjectURL(new Blob([this.script], { type: "text/javascript" }));
    this.worker = new Worker(address);
    this.worker.addEventListener("message", ({ data }) => this.#receive(data));
    this.worker.addEventListener("error", (event) => this.stop(event.message || "the simulator's thread does not start"));
    const { described } = await this.ask("start", { bytes: this.bytes });
    URL.revokeObjectURL(address);
    return described;
  }

  /** Asks a question; returns the answer, or throws an `Unanswered`. */
  ask(kind, message) {
    return new Promise((resolve, reject) => {
      if (!this.worker) {
        throw new Unanswered({ words: "it is not running" });
      }
      this.lastId += 1;
      const id = this.lastId;
      const timeout = setTimeout(() => this.stop("it took too long"), PATIENCE);
      this.open.set(id, { resolve, reject, timeout, askedAt: performance.now() });
      this.worker.postMessage({ id, kind, ...message });
    });
  }

  #receive({ id, answer, error }) {
    const question = this.open.get(id);
    if (!question) {
      return;
    }
    this.open.delete(id);
    clearTimeout(question.timeout);
    if (error) {
      question.reject(new Unanswered(error));
    } else {
      question.resolve(answer);
    }
  }
}
