// A game in rounds: the visitor and the law lead the same flocks. The mean over rounds counts.

import { withSign } from "../flockenv/replay/shared/words.mjs";

/** Length of a round in s. */
export const ROUND_SECONDS = 300;

const signed = (value) => withSign(value, 2);
const mean = (values) => values.reduce((sum, value) => sum + value, 0) / values.length;

/** Mean over flocks of each flock's mean signed order so far. */
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

  /** Starts another game if the flock has changed; `flock`: its fields in links, of which the seed does not count. */
  play({ seed: _, ...fields }) {
    const flock = JSON.stringify(Object.entries(fields).sort());
    if (flock !== this.#flock) {
      this.rounds = [];
      this.#flock = flock;
    }
  }

  /** Adds the scores of a round; returns a sentence about them. */
  end(yours, law) {
    this.rounds.push([yours, law]);
    const [yourScore, lawScore] = [signed(yours), signed(law)];
    const winner = yours > law ? "you lead better" : "the law leads better";
    return `Round ${this.rounds.length}: ${yourScore === lawScore ? "a draw" : winner}, you ${yourScore}, the law ${lawScore}. “Again” starts round ${this.rounds.length + 1}.`;
  }

  /** The score over all rounds as a sentence; empty before the first round is over. */
  get words() {
    const { length } = this.rounds;
    if (length === 0) {
      return "";
    }
    const won = this.rounds.filter(([yours, law]) => signed(yours) !== signed(law) && yours > law).length;
    const [yours, law] = [0, 1].map((index) => signed(mean(this.rounds.map((scores) => scores[index]))));
    return `${length === 1 ? "1 round" : `mean of ${length} rounds`}: you ${yours}, the law ${law}; ${won} won`;
  }
}
