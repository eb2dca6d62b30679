// Signed order against flock-hours of training, with the paper's law as a line.

import { fitted } from "../flockenv/replay/shared/scene.mjs";
import { fixed, plain, withSign } from "../flockenv/replay/shared/words.mjs";

const EDGE_OF_CURVE = { left: 34, right: 12, top: 8, bottom: 32 };
/** The signed orders that the axis always includes. */
const [LOW, HIGH] = [-0.1, 0.5];

export class LearningCurve {
  /** Flock-hours and signed order of each judgment. */
  points = [];
  /** The signed order of the paper's law, and the flock-hours at the end. */
  law = NaN;
  end = 1;

  constructor(canvas) {
    this.canvas = canvas;
  }

  /** Removes the points, for a training that ends after `end` flock-hours. */
  clear(end, law) {
    Object.assign(this, { points: [], end, law });
  }

  /** The flock-hours at which the next judgment is due; judgments are equally spaced over the training. */
  next(judgments) {
    return Math.min(this.points.length / (judgments - 1), 1) * this.end;
  }

  add(hours, order) {
    this.points.push([hours, order]);
  }

  get last() {
    return this.points.at(-1)?.[1] ?? NaN;
  }

  draw(palette) {
    const { canvas, end, law, points } = this;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (width === 0) {
      return;
    }
    const context = fitted(canvas);
    const orders = points.map(([, order]) => order).concat(Number.isNaN(law) ? [] : law);
    const [low, high] = [Math.min(LOW, ...orders), Math.max(HIGH, ...orders)];
    const x = (hours) => EDGE_OF_CURVE.left + (hours / end) * (width - EDGE_OF_CURVE.left - EDGE_OF_CURVE.right);
    const y = (order) => EDGE_OF_CURVE.top + ((high - order) / (high - low)) * (height - EDGE_OF_CURVE.top - EDGE_OF_CURVE.bottom);
    context.clearRect(0, 0, width, height);
    context.fillStyle = palette.water;
    context.fillRect(EDGE_OF_CURVE.left, EDGE_OF_CURVE.top, width - EDGE_OF_CURVE.left - EDGE_OF_CURVE.right, height - EDGE_OF_CURVE.top - EDGE_OF_CURVE.bottom);
    this.#scales(context, palette, x, y, [width, height]);
    context.lineWidth = 2;
    if (!Number.isNaN(law)) {
      drawPoints(context, palette["paper-law"], [[0, law], [end, law]], x, y);
    }
    drawPoints(context, palette.learned, points, x, y);
    for (const [hours, order] of points) {
      context.beginPath();
      context.arc(x(hours), y(order), 3.5, 0, 2 * Math.PI);
      context.fillStyle = palette.learned;
      context.fill();
    }
    this.#labelLaw(context, palette, EDGE_OF_CURVE.left + 4, y(law) - 6);
  }

  /** Labels the law's line at its start, where the curve of untrained leaders is below it. */
  #labelLaw(context, palette, x, y) {
    if (Number.isNaN(this.law)) {
      return;
    }
    const words = `the paper's law ${withSign(this.law, 2)}`;
    context.textAlign = "left";
    context.lineWidth = 3;
    context.strokeStyle = palette.water;
    context.strokeText(words, x, y);
    context.fillStyle = palette["paper-law"];
    context.fillText(words, x, y);
  }

  #scales(context, palette, x, y, [width, height]) {
    context.fillStyle = palette.faint;
    context.font = `11px ${getComputedStyle(document.body).fontFamily}`;
    context.textAlign = "right";
    for (const order of [0, 0.25, 0.5]) {
      context.fillText(plain(order), EDGE_OF_CURVE.left - 5, y(order) + 4);
    }
    context.textAlign = "center";
    for (const hours of Number.isNaN(this.law) ? [] : [0, this.end]) {
      context.fillText(fixed(hours, 0), x(hours), height - 18);
    }
    context.fillText("flock-hours", (EDGE_OF_CURVE.left + width - EDGE_OF_CURVE.right) / 2, height - 4);
  }
}

function drawPoints(context, color, points, x, y) {
  context.beginPath();
  for (const [hours, order] of points) {
    context.lineTo(x(hours), y(order));
  }
  context.strokeStyle = context.fillStyle = color;
  context.stroke();
}
