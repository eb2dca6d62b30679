// The picture of a run at one time: water, walls, trails, boats, forces.

import { drawForces } from "./forces.mjs";

const MARGIN = 0.022;
const TRAIL_PIECES = 6;

/** Names of the colors of runs: of laws, as in plots, and of other runs. */
const LAW_COLORS = ["paper-law", "damped-law", "tuned-law", "learned"];
const OTHER_COLORS = ["run-1", "run-2"];

/** Gives each run the color of the law that leads it, unless a run with another name has that color already; then, or without a law, one of the others. */
export function giveColors(runs) {
  const nameByColor = new Map();
  for (const run of runs) {
    // A law has one color, whether it acts at every substep or at every decision.
    const law = (run.leaders > 0 && run.law ? run.law : "").replace(/ at every .*/, "");
    const colorName = law.replace("'s", "").replaceAll(" ", "-");
    const candidates = [...LAW_COLORS.filter((color) => color === colorName), ...OTHER_COLORS];
    run.color = candidates.find((color) => (nameByColor.get(color) ?? run.name) === run.name) ?? OTHER_COLORS.at(-1);
    nameByColor.set(run.color, run.name);
  }
}

/** Colors of the style sheet, by name. */
export function colors() {
  const style = getComputedStyle(document.documentElement);
  const names = ["ground", "wall", "water", "grid", "ink", "faint", "target", "clockwise", "counter-clockwise", "radial", "normal",
    "mark", "leader", "opponent", "leader-mark", "outline", "force", "pin", ...LAW_COLORS, ...OTHER_COLORS, "track", "circles-from"];
  const palette = Object.fromEntries(names.map((name) => [name, style.getPropertyValue(`--${name}`).trim()]));
  // Two further digits are the opacity.
  return { ...palette, window: `${palette.ink}12` };
}

/** Fits a canvas's pixels to its size on the page; returns its context in CSS pixels. */
export function fitted(canvas) {
  const ratio = window.devicePixelRatio || 1;
  const width = Math.round(canvas.clientWidth * ratio);
  const height = Math.round(canvas.clientHeight * ratio);
  if (canvas.width !== width || canvas.height !== height) {
    [canvas.width, canvas.height] = [width, height];
  }
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  return context;
}

/** The name of a boat's color, by the direction in which it heads around the center; `circlesFrom`: least sine of its angle to the radius at which it counts as circling. */
export function tintOf([x, y, heading], circlesFrom) {
  // The sine of the angle clockwise from the outward direction.
  const clockwise = Math.sin(Math.atan2(y, x) - heading);
  if (Math.abs(clockwise) < circlesFrom) {
    return "radial";
  }
  return clockwise > 0 ? "clockwise" : "counter-clockwise";
}

export class Scene {
  poses = [];
  palette = null;
  context = null;
  /** The canvas's middle in pixels, the point in cm that is drawn there, and pixels per cm. */
  middle = [0, 0];
  center = [0, 0];
  scale = 1;
  isTinted = false;

  constructor(canvas, run) {
    this.canvas = canvas;
    this.run = run;
  }

  /**
   * `forceScale` is the force drawn half as long as a hull is wide; null draws none. `coloring`: whether color shows
   * the "direction" in which boats circle, or their "role".
   */
  draw(time, { trailSeconds, forceScale, boat, coloring, palette }) {
    this.poses = this.run.posesAt(time);
    if (this.canvas.clientWidth === 0) {
      return;
    }
    this.context = fitted(this.canvas);
    this.palette = palette;
    const { outer_radius_cm: outer, inner_radius_cm: inner } = this.run.lengths;
    // In open water there is no center to circle around.
    this.isTinted = coloring === "direction" && (outer !== null || inner > 0);
    this.#setView();
    this.#water();
    if (trailSeconds > 0) {
      this.#trails(time, trailSeconds, boat);
    }
    const isPresent = (k) => !Number.isNaN(this.poses[k][0]);
    for (let k = this.run.boats - 1; k >= 0; k -= 1) {
      // A canvas ignores a translation by NaN, and would draw a missing boat in its corner.
      if (isPresent(k)) {
        this.#boat(k);
      }
    }
    if (forceScale !== null && this.run.hasForces) {
      drawForces(this, this.run.sampleAt(time), forceScale);
    }
    if (boat !== null && boat < this.run.boats && isPresent(boat)) {
      this.#markChosen(boat);
    }
  }

  /** The boat under a point of the canvas, or null. */
  boatAt(x, y) {
    const { hull_radius_cm: radius, hull_half_length_cm: half } = this.run.lengths;
    let closestBoat = null;
    let closest = Math.max(radius * this.scale, 6);
    this.poses.forEach(([, , heading], boat) => {
      const [cx, cy] = this.pixelOf(boat);
      const [dx, dy] = [x - cx, y - cy];
      const [ux, uy] = [Math.cos(heading), -Math.sin(heading)];
      const length = half * this.scale;
      const along = Math.min(Math.max(dx * ux + dy * uy, -length), length);
      const distance = Math.hypot(dx - along * ux, dy - along * uy);
      if (distance <= closest) {
        [closestBoat, closest] = [boat, distance];
      }
    });
    return closestBoat;
  }

  /** A boat's position on the canvas. */
  pixelOf(boat) {
    return this.pixel(this.poses[boat][0], this.poses[boat][1]);
  }

  /** The position of a point in cm on the canvas. */
  pixel = (x, y) => {
    return [
      this.middle[0] + (x - this.center[0]) * this.scale,
      this.middle[1] - (y - this.center[1]) * this.scale,
    ];
  };

  /** Sets center and scale so that the whole pool is in view, or all boats in open water. */
  #setView() {
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight];
    this.middle = [width / 2, height / 2];
    const side = Math.min(width, height);
    const outer = this.run.lengths.outer_radius_cm;
    if (outer !== null) {
      this.center = [0, 0];
      this.scale = (side * (0.5 - MARGIN)) / outer;
      return;
    }
    const present = this.poses.filter((pose) => !Number.isNaN(pose[0]));
    if (present.length === 0) {
      return; // Without a boat in view, the view stays.
    }
    const xs = present.map((pose) => pose[0]);
    const ys = present.map((pose) => pose[1]);
    const [left, right] = [Math.min(...xs), Math.max(...xs)];
    const [low, high] = [Math.min(...ys), Math.max(...ys)];
    this.center = [(left + right) / 2, (low + high) / 2];
    const reach = this.run.lengths.hull_radius_cm + this.run.lengths.hull_half_length_cm;
    const half = Math.max(right - left, high - low, 16 * reach) / 2 + 3 * reach;
    // The scale changes in steps, so that the picture does not constantly shrink and grow.
    this.scale = 2 ** (Math.floor(4 * Math.log2((0.42 * side) / half)) / 4);
  }

  #water() {
    const { context, palette, run } = this;
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight];
    const { outer_radius_cm: outer, inner_radius_cm: inner } = run.lengths;
    const wall = Math.max(Math.min(width, height) / 200, 1);
    context.clearRect(0, 0, width, height);
    if (outer === null) {
      context.fillStyle = palette.water;
      context.fillRect(0, 0, width, height);
      this.#grid(width, height);
    } else {
      this.#disc(0, 0, outer * this.scale + wall, palette.wall);
      this.#disc(0, 0, outer * this.scale, palette.water);
    }
    this.#obstacles(outer, wall);
    if (inner > 0) {
      this.#disc(0, 0, inner * this.scale, palette.wall);
      this.#disc(0, 0, inner * this.scale - wall, palette.ground);
      if (run.target !== null && inner * this.scale >= 24) {
        this.#arrow(0.66 * inner * this.scale);
      }
    }
  }

  /** Draws discs and walls as one shape, and nothing beyond the pool's outer wall. */
  #obstacles(outer, wall) {
    const { context, palette, run } = this;
    context.save();
    if (outer !== null) {
      context.beginPath();
      context.arc(...this.pixel(0, 0), outer * this.scale, 0, 2 * Math.PI);
      context.clip();
    }
    context.strokeStyle = palette.wall;
    context.lineWidth = wall;
    context.lineCap = "round";
    for (const [x0, y0, x1, y1] of run.walls) {
      context.beginPath();
      context.moveTo(...this.pixel(x0, y0));
      context.lineTo(...this.pixel(x1, y1));
      context.stroke();
    }
    for (const [inset, color] of [[0, palette.wall], [wall, palette.ground]]) {
      for (const [x, y, radius] of run.discs) {
        this.#disc(x, y, radius * this.scale - inset, color);
      }
    }
    context.restore();
  }

  #disc(x, y, radius, color) {
    const { context } = this;
    context.beginPath();
    context.arc(...this.pixel(x, y), Math.max(radius, 0), 0, 2 * Math.PI);
    context.fillStyle = color;
    context.fill();
  }

  #grid(width, height) {
    const { context } = this;
    const decade = 10 ** Math.floor(Math.log10(60 / this.scale));
    const spacing = [1, 2, 5, 10].map((step) => step * decade).find((s) => s * this.scale >= 60);
    context.strokeStyle = this.palette.grid;
    context.lineWidth = 1;
    context.beginPath();
    const firstLine = (center, size) => Math.ceil((center - size / 2 / this.scale) / spacing) * spacing;
    for (let x = firstLine(this.center[0], width); ; x += spacing) {
      const px = Math.round(this.pixel(x, 0)[0]) + 0.5;
      if (px > width) break;
      context.moveTo(px, 0);
      context.lineTo(px, height);
    }
    for (let y = firstLine(this.center[1], height); ; y += spacing) {
      const py = Math.round(this.pixel(0, y)[1]) + 0.5;
      if (py < 0) break;
      context.moveTo(0, py);
      context.lineTo(width, py);
    }
    context.stroke();
  }

  /** Draws the target: most of a circle, with an arrowhead at its end. */
  #arrow(radius) {
    const { context, palette } = this;
    const turn = this.run.target === "cw" ? 1 : -1;
    const [x, y] = this.pixel(0, 0);
    const head = Math.max(radius / 6, 5);
    const start = -0.5 * Math.PI + turn * 0.25 * Math.PI;
    const end = -0.5 * Math.PI + turn * 1.8 * Math.PI;
    context.strokeStyle = context.fillStyle = palette.target;
    context.lineWidth = Math.max(radius / 24, 1.5);
    context.lineCap = "round";
    context.beginPath();
    context.arc(x, y, radius, start, end, turn < 0);
    context.stroke();
    const pointAt = (angle, r) => [x + r * Math.cos(angle), y + r * Math.sin(angle)];
    context.beginPath();
    context.moveTo(...pointAt(end + (turn * head) / radius, radius));
    context.lineTo(...pointAt(end - turn * 0.02, radius + 0.6 * head));
    context.lineTo(...pointAt(end - turn * 0.02, radius - 0.6 * head));
    context.fill();
  }

  #trails(time, seconds, chosen) {
    const { context, palette, run } = this;
    const position = run.columns.get("position_cm");
    const [first, last] = [run.sampleAt(time - seconds), run.sampleAt(time)];
    context.lineJoin = context.lineCap = "round";
    for (let boat = 0; boat < run.boats; boat += 1) {
      const isBold = boat === chosen;
      context.strokeStyle = palette[this.isTinted && boat >= run.leaders ? "faint" : run.roleOf(boat)];
      context.lineWidth = isBold ? 3 : 1.4;
      for (let piece = 0; piece < TRAIL_PIECES; piece += 1) {
        const from = first + Math.floor(((last - first) * piece) / TRAIL_PIECES);
        const to = first + Math.floor(((last - first) * (piece + 1)) / TRAIL_PIECES);
        context.globalAlpha = ((isBold ? 0.9 : 0.42) * (piece + 1)) / TRAIL_PIECES;
        context.beginPath();
        for (let k = from; k <= to; k += 1) {
          context.lineTo(...this.pixel(position.at(k, 2 * boat), position.at(k, 2 * boat + 1)));
        }
        if (piece === TRAIL_PIECES - 1) {
          context.lineTo(...this.pixelOf(boat));
        }
        context.stroke();
      }
    }
    context.globalAlpha = 1;
  }

  /** Colors of a boat's ring (null for no ring), body and mark. */
  #colorsOf(boat) {
    const { palette, run } = this;
    const role = run.roleOf(boat);
    if (!this.isTinted) {
      return [null, palette[role], role === "leader" ? palette["leader-mark"] : palette.mark];
    }
    return [role === "normal" ? null : palette[role], palette[tintOf(this.poses[boat], Number(palette["circles-from"]))], palette.mark];
  }

  /** Draws a boat: outline, ring, body, and a mark that points to its bow. */
  #boat(boat) {
    const { context, palette, run } = this;
    const radius = Math.max(run.lengths.hull_radius_cm * this.scale, 1);
    const half = run.lengths.hull_half_length_cm * this.scale;
    const line = Math.min(Math.max(0.14 * radius, 1), 0.3 * radius);
    const [ring, body, mark] = this.#colorsOf(boat);
    const fill = (reach, color) => {
      context.beginPath();
      context.arc(half, 0, Math.max(reach, 0), -Math.PI / 2, Math.PI / 2);
      context.arc(-half, 0, Math.max(reach, 0), Math.PI / 2, 1.5 * Math.PI);
      context.closePath();
      context.fillStyle = color;
      context.fill();
    };
    context.save();
    context.translate(...this.pixelOf(boat));
    context.rotate(-this.poses[boat][2]);
    fill(radius, palette.outline);
    if (ring) {
      fill(radius - line, ring);
    }
    const inner = radius - line - (ring ? Math.min(Math.max(0.34 * radius, 1.8), radius - line) : 0);
    fill(inner, body);
    if (radius >= 2.5) {
      const reach = half + inner;
      context.fillStyle = mark;
      context.beginPath();
      context.moveTo(0.84 * reach, 0);
      context.lineTo(-0.12 * reach, -0.68 * inner);
      context.lineTo(0.1 * reach, 0);
      context.lineTo(-0.12 * reach, 0.68 * inner);
      context.fill();
    }
    context.restore();
  }

  /** Draws a circle around the chosen boat. */
  #markChosen(boat) {
    const { context, run } = this;
    const reach = (run.lengths.hull_radius_cm + run.lengths.hull_half_length_cm) * this.scale;
    context.strokeStyle = this.palette.pin;
    context.lineWidth = 2;
    context.beginPath();
    context.arc(...this.pixelOf(boat), reach + 4, 0, 2 * Math.PI);
    context.stroke();
  }
}
