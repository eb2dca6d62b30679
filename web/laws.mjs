// Steering of leaders: by the laws that the simulator lists, or by the visitor's hand.

/** Stands for the visitor in links and requests, in place of a law's name. */
export const YOU = "you";
/** The leaders that the visitor trained. */
export const TRAINED = "trained";

export class Laws {
  /** `listed`: the simulator's table. The first law acts at every substep, the others at each decision of a leader. */
  constructor(listed) {
    const names = listed.map(({ name }) => name);
    [this.atEverySubstep] = names;
    this.ofEach = names.slice(1);
  }

  /** Choices for all leaders together: the laws (the first one of those with the same words), the trained leaders, and the visitor. */
  get ofAll() {
    const alike = [this.atEverySubstep, ...this.ofEach].filter((name, index, names) =>
      names.findIndex((other) => this.words(other) === this.words(name)) === index);
    return [...alike, TRAINED, YOU];
  }

  /** A law in words, which do not say how often it acts. */
  words(name) {
    const kind = name.replace(/ at every .*/, "");
    if (kind === YOU) {
      return kind;
    }
    if (kind === TRAINED) {
      return "what you trained";
    }
    return kind.endsWith(" law") ? `the ${kind}` : `${kind} steering`;
  }

  /** A law for each of several leaders: those of a list, or the one law. One law if there are not several leaders. */
  forEach(policy, leaders) {
    const given = policy.split(",").map((name) => (this.ofEach.includes(name) ? name : this.ofEach[0]));
    return leaders > 1 ? Array.from({ length: leaders }, (_, k) => given[k] ?? given.at(-1)).join(",") : given[0];
  }
}
