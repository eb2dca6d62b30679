// A game in rounds: the visitor and the law lead the same flocks. The mean over rounds counts.

import { fixed } from "../flockenv/replay/shared/words.mjs";

/** Length of a round in s. */
export const ROUND_SECONDS = 300;

const signed = (value) => fixed(value, 2, true);
const mean = (values) => values.reduce((sum, value) => sum + value, 0) / values.length;

/** Mean over flocks of the mean signed order until now. */
export function scoreOf(runs) {
  return mean(runs.map((run) => run.mean("signed_order")));
}

export class Game {
  /** Scores of the rounds that are over: of the visitor and of the law. */
  rounds = [];
  #flock = "";

  /** Whether a round is over by this time, in s. */
  static isOver(seconds) {
    return seconds >= ROUND_SECONDS;
  }

  /** Starts another game if the flock, as described in links, has changed. */
  play({ seed: _, ...flock }) {
    const kind = JSON.stringify(Object.entries(flock).sort());
    if (kind !== this.#flock) {
      Object.assign(this, { rounds: [] });
      this.#flock = kind;
    }
  }

  /** Counts a round; returns a sentence about it. */
  end(yours, law) {
    this.rounds.push([yours, law]);
    const [you, it] = [signed(yours), signed(law)];
    const won = { true: "you lead better", false: "the law leads better" }[yours > law];
    return `Round ${this.rounds.length}: ${you === it ? "a draw" : won}, you ${you}, the law ${it}. “Again” starts round ${this.rounds.length + 1}.`;
  }

  /** The score over all rounds as a sentence; empty before the first round is over. */
  get words() {
    const { length } = this.rounds;
    if (length === 0) {
      return "";
    }
    const won = this.rounds.filter(([yours, law]) => signed(yours) !== signed(law) && yours > law).length;
    const [yours, law] = [0, 1].map((who) => signed(mean(this.rounds.map((round) => round[who]))));
    return `${length === 1 ? "1 round" : `mean of ${length} rounds`}: you ${yours}, the law ${law}; ${won} won`;
  }
}
