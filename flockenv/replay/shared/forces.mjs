// Contact forces as bars, whose length is in proportion to the force.

import { roundNumber } from "./words.mjs";

/** Longest bar, in widths of a hull; those of stronger forces end in an arrowhead. */
export const LONGEST = 6;
/** Bars shorter than this part of a hull's width are left out. */
const SHORTEST = 0.05;
/** Largest number of forces that the scale is chosen from. */
const MOST_SAMPLES = 20_000;

/**
 * The force, in cm/s², that is drawn as long as a hull is wide: a round number near what nine in ten contacts
 * stay below. The runs of a page share it.
 */
export function forceScale(runs) {
  const forces = [];
  for (const run of runs.filter((each) => each.hasForces)) {
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

/** A force's bar: its length in hull widths, 0 for none, and whether it is cut off. */
export function barOf(force, scale) {
  const widths = force / scale;
  return { widths: widths < SHORTEST ? 0 : Math.min(widths, LONGEST), cut: widths > LONGEST };
}

/**
 * Draws the bars of a sample. Each starts where hulls, or a hull and a wall, press, and lies on the boat that is
 * pushed, the way it is pushed.
 */
export function drawForces(scene, sample, scale) {
  const { run } = scene;
  const { hull_radius_cm: radius } = run.lengths;
  for (const { i, j, along, angle, force } of run.contacts(sample)) {
    const bar = barOf(force, scale);
    if (bar.widths === 0) {
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

function drawBar({ context, palette, scale, run, pixel }, point, angle, { widths, cut }) {
  const radius = run.lengths.hull_radius_cm * scale;
  const [length, half] = [2 * widths * radius, Math.max(0.15 * radius, 1)];
  context.save();
  context.translate(...pixel(...point));
  context.rotate(-angle);
  for (const [color, extra] of [[palette.mark, 1], [palette.force, 0]]) {
    context.fillStyle = color;
    context.fillRect(0, -half - extra, length + extra, 2 * (half + extra));
    if (cut) {
      context.beginPath();
      context.moveTo(length + 5 * half + 2 * extra, 0);
      context.lineTo(length, 3 * half + extra);
      context.lineTo(length, -3 * half - extra);
      context.fill();
    }
  }
  context.restore();
}
