// Contact forces as bars whose area is in proportion to the force. Bars are less than half a boat long: a larger force makes them wider.

import { roundNumber } from "./words.mjs";

/** In hull widths: length of the bar of a force equal to the scale, and width of bars that are not at their greatest length. */
const [LENGTH, NARROWEST] = [0.5, 0.2];
/** Length of the longest bar, in lengths of a boat. Bars at both ends of a boat leave a gap, so that the bars of a jam do not join into one line. */
const LONGEST = 0.45;
/** Bars shorter than this fraction of a hull's width are left out. */
const SHORTEST = 0.025;
/** Largest number of forces from which the scale is chosen. */
const MOST_SAMPLES = 20_000;

/**
 * The force, in cm/s², that is drawn half as long as a hull is wide: a round number. About nine in ten contacts
 * stay below its double. All runs of a page share it.
 */
export function forceScale(runs) {
  const forces = [];
  for (const run of runs.filter((candidate) => candidate.hasForces)) {
    const column = run.columns.get("contact_force");
    const every = Math.max(1, Math.ceil(column.length / MOST_SAMPLES));
    for (let k = 0; k < column.length; k += every) {
      forces.push(column.at(k));
    }
  }
  forces.sort((a, b) => a - b);
  const typical = forces[Math.floor(0.9 * (forces.length - 1))];
  return typical > 0 ? roundNumber(typical / 2) : 1;
}

/** Length and width of the bar of a force, in hull widths; so is `boatLength`. A bar is at most as wide as a boat; length 0 means no bar. */
export function barOf(force, scale, boatLength) {
  const [proportional, longest] = [(LENGTH * force) / scale, LONGEST * boatLength];
  const length = proportional < SHORTEST ? 0 : Math.min(proportional, longest);
  return { length, width: Math.min(NARROWEST * Math.max(proportional / longest, 1), 1) };
}

/**
 * Draws the bars of a sample. Each starts at the contact and lies on the boat that is pushed, in the
 * direction of the push.
 */
export function drawForces(scene, sample, scale) {
  const { run } = scene;
  const { hull_radius_cm: radius, hull_half_length_cm: half } = run.lengths;
  for (const { i, j, along, angle, force } of run.contacts(sample)) {
    const bar = barOf(force, scale, 1 + half / radius);
    if (bar.length === 0) {
      continue;
    }
    const [x, y, heading] = scene.poses[i];
    const point = [
      x + along * Math.cos(heading) - radius * Math.cos(angle),
      y + along * Math.sin(heading) - radius * Math.sin(angle),
    ];
    drawBar(scene, point, angle, bar);
    if (j >= 0) {
      drawBar(scene, point, angle + Math.PI, bar);
    }
  }
}

function drawBar({ context, palette, scale, run, pixel }, point, angle, bar) {
  const hull = 2 * run.lengths.hull_radius_cm * scale;
  const [length, width] = [bar.length * hull, Math.max(bar.width * hull, 2)];
  context.save();
  context.translate(...pixel(...point));
  context.rotate(-angle);
  for (const [color, border] of [[palette.mark, 1], [palette.force, 0]]) {
    context.fillStyle = color;
    context.fillRect(0, -width / 2 - border, length + border, width + 2 * border);
  }
  context.restore();
}
