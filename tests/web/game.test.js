// Law: the score of a game is the mean over its rounds, in the digits that are shown.

import assert from "node:assert/strict";
import { test } from "node:test";
import { Game, ROUND_SECONDS, scoreOf } from "../../web/game.mjs";

test("a round is over when its time is", () => {
  assert.equal(Game.isOver(ROUND_SECONDS - 0.1), false);
  assert.equal(Game.isOver(ROUND_SECONDS), true);
});

test("a score is the mean over flocks", () => {
  assert.equal(scoreOf([0.1, 0.2, 0.6].map((value) => ({ mean: () => value }))), 0.3);
});

test("the higher order wins a round, and what is shown alike is a draw", () => {
  const game = new Game();
  assert.equal(game.words, "");
  assert.equal(game.end(0.5, -0.2), "Round 1: you lead better, you +0.50, the law −0.20. “Again” starts round 2.");
  assert.equal(game.words, "1 round: you +0.50, the law −0.20; 1 won");
  assert.equal(game.end(-0.3, 0.25), "Round 2: the law leads better, you −0.30, the law +0.25. “Again” starts round 3.");
  assert.match(game.end(0.2512, 0.2488), /^Round 3: a draw, /);
  assert.equal(game.words, "mean of 3 rounds: you +0.15, the law +0.10; 1 won");
});

test("another start is another round, and another flock another game", () => {
  const game = new Game();
  game.play({ n_boats: "14", seed: "1" });
  game.end(0.5, 0.2);
  game.play({ seed: "4", n_boats: "14" });
  assert.equal(game.rounds.length, 1);
  game.play({ n_boats: "15", seed: "4" });
  assert.equal(game.rounds.length, 0);
});
