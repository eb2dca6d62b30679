// The page's opening and its lessons. A lesson has a link, sentences above and below the picture, in which there may be links, and
// `headline`, the quantity in large type if it is not the order.

import { element } from "../flockenv/replay/shared/words.mjs";

/** The flock of a page that is opened without a link: it circles. */
export const OPENING = "#preset=experiment&n_boats=27&bw_s=0.8&seed=5&start=180&speed=4";
const OPENING_WORDS = {
  before: "These boats only bump into each other, and yet they circle together. How long they back up in each cycle decides it: try the slider.",
  after: "Blue boats head clockwise, orange ones counter-clockwise, gray ones neither.",
};

/** Stands in place of a lesson's name while a recording is shown. */
export const RECORDING = "a recording";
const RECORDING_WORDS = {
  before: "This is a recording, from a file. The slider goes to any of its times, and “again” returns to the flock where it was.",
  after: OPENING_WORDS.after,
};

const NOISE = "#lesson=noise&preset=experiment&n_boats=27&seed=16&start=180&speed=8";
const OPPOSED = "#lesson=opposed&n_boats=27&n_leaders=4&bw_s=0.3&seed=2&speed=16";
export const LESSONS = [
  {
    name: "steer",
    title: "Lead them yourself",
    link: "#lesson=steer&pool=narrow&n_boats=12&n_leaders=4&bw_s=0.2&seed=1&flocks=3&leaders=you&beside.leaders=paper's law at every substep&speed=8",
    before: "Steer the ringed boats by slider [or arrow keys] to start. Goal: in 5 minutes (38 s at 8 ×) more clockwise boats than the paper's law.",
    after: "Leaders lead by being in the way. Score: 1 if all others circle with the arrow, −1 if all go against it.",
  },
  {
    name: "noise",
    title: "Backing frees a jam",
    link: `${NOISE}&bw_s=0`,
    headline: "rotation",
    before: `Boats that never back up jam at the wall. Let them back up for {[0 s](${NOISE}&bw_s=0), [0.8 s](${NOISE}&bw_s=0.8) or [2.8 s](${NOISE}&bw_s=2.8)}.`,
    after: "Backing frees boats that crowd the wall; too much ends the order. Sparse flocks need only random turning.",
  },
  {
    name: "leaders",
    title: "One leader or four",
    link: "#lesson=leaders&n_boats=27&n_leaders=1&bw_s=0.3&seed=14&beside.n_leaders=4&speed=16",
    before: "Without leaders, chance decides the direction. A few leaders decide it instead.",
    after: "In 256 flocks backing 0.31 s, one leader reaches 0.13, four 0.38. One flock varies, and takes minutes.",
  },
  {
    name: "learned",
    title: "Learned or law",
    link: "#lesson=learned&n_boats=27&n_leaders=4&bw_s=0.3&seed=14&beside.leaders=learned&speed=16",
    before: "Four leaders by the paper's law, and beside them four that learned by trial and error where to head.",
    after: "In 256 flocks backing 0.31 s, learned leaders reach 0.60, the law 0.38. One flock varies, and takes minutes.",
  },
  {
    name: "train",
    title: "Train leaders",
    link: "#lesson=train&n_boats=10&n_leaders=4&pool=narrow&bw_s=0.3&seed=1&leaders=trained&speed=8",
    before: "At first these four leaders know nothing and head straight ahead. Press train: they learn what to do with their rudders.",
    after: "In pairs of flocks they try opposite rudders and keep what raises the order. The flock follows them at once.",
  },
  {
    name: "forces",
    title: "Contacts",
    link: "#lesson=forces&preset=experiment&n_boats=27&n_leaders=3&bw_s=0.4&seed=1&start=89&paused=1&speed=1&forces=1",
    before: "Motors drive forward, and each bar is a push by a boat or a wall. Nothing else aligns the flock. Play to go on.",
    after: "Bars grow with the push, then wider. Touch a boat for its numbers, a ringed one for what a leader observes.",
  },
  {
    name: "opposed",
    title: "Opposed leaders",
    link: `${OPPOSED}&target=cw,cw,ccw,ccw`,
    headline: "rotation",
    before: `Leaders may disagree: try {[two against two](${OPPOSED}&target=cw,cw,ccw,ccw) and [three against one](${OPPOSED}&target=cw,cw,cw,ccw)}.`,
    after: "Rotation says who won. Two against two, chance decides; three against one, most flocks follow the three.",
  },
];

/** Elements with a link to each lesson. */
export function lessonLinks() {
  return LESSONS.map(({ name, title, link }) => {
    const anchor = element("a", "", title);
    anchor.href = link;
    anchor.dataset.lesson = name;
    return anchor;
  });
}

/** The words of a lesson by its name, those of a recording, or those of the opening. */
export function wordsOf(name) {
  return name === RECORDING ? RECORDING_WORDS : LESSONS.find((lesson) => lesson.name === name) ?? OPENING_WORDS;
}

/**
 * The elements of a story. `[words](#link)` is a link, and `[or words]` is hidden on touch screens. Words between braces stay on one
 * line, so that a finger does not touch two links.
 */
export function storyOf(words) {
  return words.split(/\{([^}]*)\}/).map((part, index) => {
    const line = element("span", index % 2 === 0 ? "" : "line");
    line.append(...part.split(/(\[[^\]]*\](?:\(#[^)]*\))?)/).map(linkOrText));
    return line;
  });
}

function linkOrText(part) {
  if (part.startsWith("[or ")) {
    return element("span", "desk", part.slice(1, -1));
  }
  const link = /^\[([^\]]*)\]\((#[^)]*)\)$/.exec(part);
  if (!link) {
    return part;
  }
  const anchor = element("a", "", link[1]);
  anchor.href = link[2];
  return anchor;
}
