// Five short lessons: a link each, and two sentences with the links that belong to them.

import { element } from "../flockenv/replay/words.mjs";

const NOISE = "#lesson=noise&preset=experiment&n_boats=27&seed=2&speed=16";
const OPPOSED = "#lesson=opposed&n_boats=27&n_leaders=4&bw_s=0.3&seed=5&speed=16";

export const LESSONS = [
  {
    name: "noise",
    title: "Noise makes motion",
    link: `${NOISE}&bw_s=0`,
    words: `These boats have no leaders and no rule to align, they only bump into each other; if they never back up ([0 s](${NOISE}&bw_s=0)), they ` +
      `jam at the wall. Backing up for [1 s](${NOISE}&bw_s=1) of each cycle turns them enough to circle together, and backing up ` +
      `for [2.8 s](${NOISE}&bw_s=2.8) turns them so much that no direction lasts.`,
  },
  {
    name: "leaders",
    title: "One leader or four",
    link: "#lesson=leaders&n_boats=27&n_leaders=1&bw_s=0.3&seed=7&beside.n_leaders=4&speed=16",
    words: "Leaders (amber) head clockwise by the paper's law, and the others know nothing of them: the first " +
      "flock has one leader, the second four. Compare the order towards the target, which is 1 if all normal boats circle clockwise.",
  },
  {
    name: "learned",
    title: "Learned or law",
    link: "#lesson=learned&n_boats=27&n_leaders=4&bw_s=0.3&seed=7&beside.leaders=tuned law&speed=16",
    words: "Both flocks start from the same places with the same noise, and each has four leaders. Those of the " +
      "first follow the paper's law, and those of the second a law that was tuned for this pool.",
  },
  {
    name: "forces",
    title: "Contacts and forces",
    link: "#lesson=forces&pool=narrow&n_boats=27&n_leaders=3&bw_s=0.1&seed=3&speed=1&boat=0&forces=1",
    words: "A bar is the push of a contact on a boat, and there is nothing else by which a boat notices others. Touch a boat " +
      "to see the local frame that its angle φ is measured in, and below, for a leader, all that it observes.",
  },
  {
    name: "opposed",
    title: "Opposed leaders",
    link: `${OPPOSED}&target=cw,cw,ccw,ccw`,
    words: "Two leaders head clockwise (amber) and two counter-clockwise (pink), and within twenty minutes this flock goes " +
      `counter-clockwise on average. With [three against one](${OPPOSED}&target=cw,cw,cw,ccw) it goes clockwise, with the three.`,
  },
];

/** The words of a lesson, with `[words](#link)` as links. */
export function storyOf({ words }) {
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
