// What the page opens with, and its lessons: a link each, a sentence before and one after, with links of their own.

import { element } from "../flockenv/replay/shared/words.mjs";

/** What the page opens with unless its link says otherwise: a flock that circles. */
export const OPENING = "#preset=experiment&n_boats=27&bw_s=0.8&seed=6&start=180&speed=4";
const OPENING_WORDS = {
  before: "These boats only bump into each other, and yet they circle together. How long they back up in each cycle decides it: try the slider.",
  after: "Blue boats head clockwise, orange ones counter-clockwise, gray ones neither.",
};

const NOISE = "#lesson=noise&preset=experiment&n_boats=27&seed=16&start=180&speed=8";
const OPPOSED = "#lesson=opposed&n_boats=27&n_leaders=4&bw_s=0.3&seed=2&speed=16";
/** How long the flock of the lesson that is a game is steered, in s. */
export const GAME_SECONDS = 120;

export const LESSONS = [
  {
    name: "steer",
    title: "Steer one yourself",
    link: "#lesson=steer&preset=experiment&n_boats=9&n_leaders=1&bw_s=1&seed=3&leaders=you&beside.leaders=paper's law at every substep&speed=4",
    before: "You steer the ringed boat with ← and →. Goal: turn the others blue, and in two minutes beat the law that knows the paper.",
    after: "A leader has no power but its bumps: it leads by being in the way.",
  },
  {
    name: "noise",
    title: "Dense flocks need noise to move",
    link: `${NOISE}&bw_s=0`,
    before: `Boats that [never back up](${NOISE}&bw_s=0) jam at the wall. Let them back up [0.8 s](${NOISE}&bw_s=0.8) or [2.8 s](${NOISE}&bw_s=2.8).`,
    after: "Some noise frees the jam of this dense flock; too much ends the order. Sparse flocks circle without noise.",
  },
  {
    name: "leaders",
    title: "One leader or four",
    link: "#lesson=leaders&n_boats=27&n_leaders=1&bw_s=0.3&seed=14&beside.n_leaders=4&speed=16",
    before: "Without leaders, chance decides the direction. A few leaders decide it instead.",
    after: "Over 256 flocks at 0.31 s the order towards the target is 0.13 with one leader and 0.38 with four.",
  },
  {
    name: "learned",
    title: "Learned or law",
    link: "#lesson=learned&n_boats=27&n_leaders=4&bw_s=0.3&seed=14&beside.leaders=learned&speed=16",
    before: "Left, four leaders follow the paper's law. Right, they learned by trial and error where to head.",
    after: "Over 256 flocks at 0.31 s the learned leaders reach 0.60, the law 0.38.",
  },
  {
    name: "forces",
    title: "Contacts",
    link: "#lesson=forces&preset=experiment&n_boats=27&n_leaders=3&bw_s=0.4&seed=1&start=89&speed=1&forces=1",
    before: "Each bar is a push, where a boat touches another or a wall. Nothing else aligns the flock.",
    after: "Touch a boat for its numbers, and a ringed one for all that a leader observes.",
  },
  {
    name: "opposed",
    title: "Opposed leaders",
    link: `${OPPOSED}&target=cw,cw,ccw,ccw`,
    before: `Leaders may disagree: try [two against two](${OPPOSED}&target=cw,cw,ccw,ccw) and [three against one](${OPPOSED}&target=cw,cw,cw,ccw).`,
    after: "Two against two, chance decides; three against one, most flocks follow the three.",
  },
];

/** The words of a lesson by its name, or those of the opening. */
export function wordsOf(name) {
  return LESSONS.find((each) => each.name === name) ?? OPENING_WORDS;
}

/** Words with `[words](#link)` as links. */
export function storyOf(words) {
  return words.split(/(\[[^\]]*\]\(#[^)]*\))/).map((part) => {
    const link = /^\[([^\]]*)\]\((#[^)]*)\)$/.exec(part);
    if (!link) {
      return part;
    }
    const anchor = element("a", "", link[1]);
    anchor.href = link[2];
    return anchor;
  });
}
