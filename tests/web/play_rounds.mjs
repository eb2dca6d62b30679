// Plays rounds of the page's game in the compiled simulator, by hands that see what the screen shows.
// Input: {wasm, rounds}; output: for each hand the scores of all rounds, and those of the law in the same flocks.

import { readFileSync } from "node:fs";
import { tintOf } from "../../flockenv/replay/shared/scene.mjs";
import { Core } from "../../web/core.mjs";
import { ROUND_SECONDS } from "../../web/game.mjs";
import { GrowingRun } from "../../web/growing_run.mjs";
import { turned } from "../../web/helm.mjs";
import { LESSONS } from "../../web/lessons.mjs";
import { readLink, requestsOf } from "../../web/request.mjs";

const { wasm, rounds } = JSON.parse(readFileSync(0, "utf8"));
const core = await Core.load(readFileSync(wasm));
const { fields, quantities, colors } = core.describe();
const kinds = Object.fromEntries(fields.map(({ name, kind }) => [name, kind]));
const series = quantities.filter(({ kind }) => kind !== "structure").map(({ name }) => name);
const circlesFrom = Number(/--circles-from:([\d.]+)/.exec(colors)[1]);
const { flock, beside, other } = readLink(LESSONS.find(({ name }) => name === "steer").link, Object.keys(kinds));
const copies = Number(other.flocks);
/** Flock seconds between two looks at the screen: a third of a second of a person's time at the lesson's speed. */
const LOOK = Number(other.speed) / 3;
const STEP = 15;
/** What a key that is held turns by between two looks: it repeats 30 times a second. */
const HELD = 10 * STEP;

/** Share of the boats that nobody steers which are blue. */
function blue(runs) {
  const tints = runs.flatMap((run) => run.posesAt(run.end).slice(run.leaders).map((pose) => tintOf(pose, circlesFrom)));
  return tints.filter((tint) => tint === "clockwise").length / tints.length;
}

/** Degrees that a hand turns by, in one look, from its heading and the flocks that it sees. */
const HANDS = {
  "off the keys": () => 0,
  "on the right key": () => HELD,
  "on the left key": () => -HELD,
  // Heads along the wall, and leans further out while few of the others are blue.
  "of a person": (heading, runs) => Math.sign((blue(runs) < 0.4 ? 45 : 75) - heading) * STEP,
};

/** The mean signed order of flocks that are steered by a hand; none for those that a law steers. */
function scoreOf(requests, hand) {
  const runs = requests.map((request, place) => {
    const { parameters, lengths } = core.open(place, request);
    const described = { boats: parameters.n_boats, leaders: parameters.n_leaders, lengths, phases: [] };
    const run = new GrowingRun(described, series);
    run.append(core.take(place));
    return run;
  });
  let heading = 0;
  for (let [samples, looks] = [0, 0]; samples < 10 * ROUND_SECONDS; samples += 1) {
    if (hand && samples >= 10 * LOOK * (looks + 1)) {
      looks += 1;
      heading = turned(heading, hand(heading, runs));
    }
    runs.forEach((run, place) => {
      core.steer(place, heading / 180);
      core.advance(place, 1, 1e9);
      run.append(core.take(place));
    });
  }
  return runs.reduce((sum, run) => sum + run.mean("signed_order"), 0) / runs.length;
}

const scores = Object.fromEntries(["the law", ...Object.keys(HANDS)].map((name) => [name, []]));
for (let round = 0; round < rounds; round += 1) {
  const start = { ...flock, seed: String(BigInt(flock.seed) + BigInt(copies * round)) };
  const requests = requestsOf({ flock: start, beside, copies }, kinds);
  scores["the law"].push(scoreOf(requests.slice(copies)));
  for (const [name, hand] of Object.entries(HANDS)) {
    scores[name].push(scoreOf(requests.slice(0, copies), hand));
  }
}
process.stdout.write(JSON.stringify(scores));
