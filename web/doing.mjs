// Sentences that describe flocks to visitors who cannot see them.

import { tintOf } from "../flockenv/replay/shared/scene.mjs";

/** Words for a fraction of the boats, each with the least fraction to which it applies. */
const SHARES = [[1, "all"], [0.9, "nearly all"], [0.6, "most"]];
const DIRECTIONS = { clockwise: "clockwise", "counter-clockwise": "counter-clockwise", radial: "against a wall" };

/** Counts a run's boats by the direction in which they head. */
function countsOf(run, sample, palette) {
  const counts = { clockwise: 0, "counter-clockwise": 0, radial: 0 };
  for (const pose of run.posesAt(run.time[sample])) {
    counts[tintOf(pose, Number(palette["circles-from"]))] += 1;
  }
  return counts;
}

/** A sentence: how many boats of each flock head clockwise. */
export function clockwiseWords(runs, time, palette) {
  const counts = runs.map((run) => countsOf(run, run.sampleAt(time), palette).clockwise);
  return `Clockwise: ${counts.join(", ")} of ${runs[0].boats} boats.`;
}

/** A sentence: which boat is chosen, whether it leads, and where it heads. */
export function boatWords(run, time, boat, palette) {
  const direction = DIRECTIONS[tintOf(run.posesAt(time)[boat], Number(palette["circles-from"]))];
  return `Boat ${boat}${boat < run.leaders ? ", a leader" : ""}: ${direction}.`;
}

/** A sentence: how many boats of a run head in each direction at a sample. */
export function flockWords(run, sample, palette) {
  const { outer_radius_cm: outer, inner_radius_cm: inner } = run.lengths;
  const boats = `${run.boats} boat${run.boats > 1 ? "s" : ""}${run.leaders > 0 ? `, ${run.leaders} of them lead` : ""}`;
  if (outer === null && inner === 0) {
    return `${boats}, in open water.`;
  }
  const counts = countsOf(run, sample, palette);
  const [direction, most] = Object.entries(counts).sort(([, a], [, b]) => b - a)[0];
  const word = SHARES.find(([least]) => most >= least * run.boats)?.[1];
  const mixed = `${counts.clockwise} clockwise, ${counts["counter-clockwise"]} counter-clockwise`;
  return `${boats}; ${word ? `${word} ${DIRECTIONS[direction]}` : mixed}.`;
}

/** A sentence: the scores of this round, from the element that shows them; `rounds`: its words about earlier rounds, which are left out. */
export function scoreWords(score, rounds) {
  const parts = Array.from(score.children, ({ textContent }) => textContent.replace(`. ${rounds}`, ""));
  return `${parts.filter(Boolean).join(", ")}.`;
}
