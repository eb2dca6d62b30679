// Five short lessons: a link each, and two sentences with the links that belong to them.

import { element } from "../flockenv/replay/shared/words.mjs";

const NOISE = "#lesson=noise&preset=experiment&n_boats=27&seed=16&speed=16";
const OPPOSED = "#lesson=opposed&n_boats=27&n_leaders=4&bw_s=0.3&seed=2&speed=16";

export const LESSONS = [
  {
    name: "noise",
    title: "Noise makes motion",
    link: `${NOISE}&bw_s=0`,
    words: "No boat leads and none looks at the others: they only bump. Each time they back up they turn at random, and as the paper " +
      `found this noise decides: boats that [never back up](${NOISE}&bw_s=0) jam at the wall, all heading outward (high order, no rotation), with ` +
      `[0.6 s](${NOISE}&bw_s=0.6) or [1 s](${NOISE}&bw_s=1) in each cycle they come to circle together, and with [2.8 s](${NOISE}&bw_s=2.8) they never agree.`,
  },
  {
    name: "leaders",
    title: "One leader or four",
    link: "#lesson=leaders&n_boats=27&n_leaders=1&bw_s=0.3&seed=14&beside.n_leaders=4&speed=16",
    words: "Without leaders chance decides which way a flock circles, and a few leaders (amber) decide it, the more the better, as the paper found, although " +
      "to the others they are boats that bump like any. The order towards the target is 1 if all others circle the leaders' way and −1 if all circle the other way: in this simulator it is 0.13 with one leader and 0.38 with four (means of 256 flocks).",
  },
  {
    name: "learned",
    title: "Learned or law",
    link: "#lesson=learned&n_boats=27&n_leaders=4&bw_s=0.3&seed=14&beside.leaders=learned&speed=16",
    words: "Both flocks have four leaders and the same start and noise; those of the first steer by the paper's rule, and those of the second learned in this " +
      "simulator, by trial and error, where to head. They lead better: the order towards the target is 0.59 with learned leaders and 0.38 with the rule (means of 256 flocks).",
  },
  {
    name: "forces",
    title: "Contacts and forces",
    link: "#lesson=forces&pool=narrow&n_boats=27&n_leaders=3&bw_s=0.1&seed=3&speed=1&boat=0&forces=1",
    words: "A bar is the push that a boat gets where it touches another or a wall, and such pushes alone, as the paper found, align a flock. " +
      "Touch a boat to see the local frame that its angle φ is measured in, and an amber one, a leader, to see all that it observes.",
  },
  {
    name: "opposed",
    title: "Opposed leaders",
    link: `${OPPOSED}&target=cw,cw,ccw,ccw`,
    words: `Not in the paper: with [two against two](${OPPOSED}&target=cw,cw,ccw,ccw), amber leaders clockwise and pink ones counter-clockwise, chance ` +
      `decides whom a flock follows, and this one mostly follows the amber. With [three against one](${OPPOSED}&target=cw,cw,cw,ccw) ` +
      "most flocks, and this one too, follow the three.",
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
