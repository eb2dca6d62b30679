// Steering of leaders: by the laws that the simulator lists, or by the visitor's hand.

/** The name of steering by the visitor, in links and requests. */
export const YOU = "you";
/** The name of the policy that the visitor trained. */
export const TRAINED = "trained";

export class Laws {
  /** `listed`: the simulator's table. The first law acts at every substep, the others at each decision of a leader. */
  constructor(listed) {
    const names = listed.map(({ name }) => name);
    [this.atEverySubstep] = names;
    this.leaderChoices = names.slice(1);
  }

  /** Names of the policies that all leaders may share: the laws (of laws with the same words only the first), the trained policy, and the visitor. */
  get sharedChoices() {
    const names = [this.atEverySubstep, ...this.leaderChoices].filter((name, index, all) =>
      all.findIndex((other) => this.words(other) === this.words(name)) === index);
    return [...names, TRAINED, YOU];
  }

  /** A law in words, which do not say how often it acts. */
  words(name) {
    const law = name.replace(/ at every .*/, "");
    if (law === YOU) {
      return law;
    }
    if (law === TRAINED) {
      return "what you trained";
    }
    return law.endsWith(" law") ? `the ${law}` : `${law} steering`;
  }

  /**
   * A law for each leader, separated by commas, from a list that may be shorter: further leaders have its last law, and a name
   * outside `leaderChoices` stands for the first of them. A single law if there is at most one leader.
   */
  policiesFor(policy, leaders) {
    const laws = policy.split(",").map((name) => (this.leaderChoices.includes(name) ? name : this.leaderChoices[0]));
    return leaders > 1 ? Array.from({ length: leaders }, (_, k) => laws[k] ?? laws.at(-1)).join(",") : laws[0];
  }
}
