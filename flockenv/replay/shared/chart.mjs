// A series against time, for every run, with a cursor that a click or drag moves.

import { span } from "./run.mjs";
import { fitted } from "./scene.mjs";
import { caption, clockText, element, fixed, plain, roundNumber } from "./words.mjs";

const EDGE = { left: 40, right: 10, top: 8, bottom: 20 };

export class Chart {
  /** `reach` in s shows that much before and after the cursor; null shows the whole run. */
  constructor(canvas, runs, reach, seek) {
    Object.assign(this, { canvas, runs, reach, cached: null, draggedRange: null });
    const go = (event) => seek(this.timeAt(event.clientX - canvas.getBoundingClientRect().left));
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      this.draggedRange = [this.from, this.to];
      go(event);
    });
    canvas.addEventListener("pointermove", (event) => canvas.hasPointerCapture(event.pointerId) && go(event));
    canvas.addEventListener("lostpointercapture", () => { this.draggedRange = null; });
  }

  /** Sets the charted times, `from` and `to`: as at the start of a drag, around the cursor, or the whole run. */
  #setTimes(time) {
    const [start, end] = span(this.runs);
    [this.from, this.to] = [start, Math.max(end, start + 1e-3)];
    if (this.draggedRange) {
      [this.from, this.to] = this.draggedRange;
    } else if (this.reach !== null && end - start > 2 * this.reach) {
      this.from = Math.min(Math.max(time - this.reach, start), end - 2 * this.reach);
      this.to = this.from + 2 * this.reach;
    }
  }

  timeAt(x) {
    const fraction = (x - EDGE.left) / (this.width - EDGE.left - EDGE.right);
    return this.from + fraction * (this.to - this.from);
  }

  xOf(time) {
    const fraction = (time - this.from) / (this.to - this.from);
    return EDGE.left + fraction * (this.width - EDGE.left - EDGE.right);
  }

  yOf(value) {
    const [low, high] = this.range;
    const height = this.height - EDGE.top - EDGE.bottom;
    return EDGE.top + ((high - value) / (high - low)) * height;
  }

  draw(time, quantity, palette) {
    [this.width, this.height] = [this.canvas.clientWidth, this.canvas.clientHeight];
    if (this.width === 0) {
      return;
    }
    this.#setTimes(time);
    this.range = quantity.range ?? valueRange(this.runs, quantity.key);
    const context = fitted(this.canvas);
    if (this.reach === null) {
      this.#drawCached(context, quantity, palette);
    } else {
      this.#drawAll(context, quantity, palette);
    }
    const x = this.xOf(time);
    context.strokeStyle = palette.ink;
    context.lineWidth = 1.5;
    context.beginPath();
    context.moveTo(x, EDGE.top - 4);
    context.lineTo(x, this.height - EDGE.bottom);
    context.stroke();
  }

  /** Draws the whole run from a cached picture, which is drawn again only if the size, the series or the colors change. */
  #drawCached(context, quantity, palette) {
    const key = JSON.stringify([this.canvas.width, this.canvas.height, quantity.key, palette]);
    if (this.cached?.key !== key) {
      const picture = document.createElement("canvas");
      [picture.width, picture.height] = [this.canvas.width, this.canvas.height];
      const pictureContext = picture.getContext("2d");
      pictureContext.setTransform(context.getTransform());
      this.#drawAll(pictureContext, quantity, palette);
      this.cached = { key, picture };
    }
    context.clearRect(0, 0, this.width, this.height);
    context.drawImage(this.cached.picture, 0, 0, this.width, this.height);
  }

  #drawAll(context, quantity, palette) {
    context.clearRect(0, 0, this.width, this.height);
    if (this.reach !== null) {
      this.#windows(context, palette);
    }
    this.#axes(context, palette);
    for (const run of this.runs) {
      const column = run.columns.get(quantity.key);
      if (column) {
        const samplesInView = (run.length * (this.to - this.from)) / (run.time.at(-1) - run.time[0] || 1);
        const draw = samplesInView > 2 * this.width ? drawBand : drawLine;
        draw(this, context, run, column, palette[run.color]);
      }
    }
  }

  /** Shades the analysis windows of the first run. */
  #windows(context, palette) {
    const run = this.runs[0];
    context.fillStyle = palette.window;
    const last = run.sampleAt(this.to);
    let start = null;
    for (let k = run.sampleAt(this.from); k <= last; k += 1) {
      const inside = run.inWindow(k);
      if (inside && start === null) {
        start = run.time[k];
      }
      if (start !== null && (!inside || k === last)) {
        const left = Math.max(this.xOf(start), EDGE.left);
        const right = Math.min(this.xOf(run.time[k]), this.width - EDGE.right);
        context.fillRect(left, EDGE.top, Math.max(right - left, 0), this.height - EDGE.top - EDGE.bottom);
        start = null;
      }
    }
  }

  #axes(context, palette) {
    const { width, height } = this;
    context.font = `11px ${getComputedStyle(document.body).fontFamily}`;
    context.lineWidth = 1;
    context.textBaseline = "middle";
    context.textAlign = "right";
    const [low, high] = this.range;
    for (const value of ticks(low, high, Math.max(height / 34, 2))) {
      const y = Math.round(this.yOf(value)) + 0.5;
      context.strokeStyle = palette.grid;
      context.beginPath();
      context.moveTo(EDGE.left, y);
      context.lineTo(width - EDGE.right, y);
      context.stroke();
      context.fillStyle = palette.faint;
      context.fillText(plain(value), EDGE.left - 6, y);
    }
    context.textBaseline = "alphabetic";
    context.textAlign = "center";
    for (const time of ticks(this.from, this.to, Math.max(width / 90, 2), timeStep)) {
      context.fillStyle = palette.faint;
      context.fillText(clockText(time), Math.min(this.xOf(time), width - 22), height - 5);
    }
  }
}

/** The line above a chart: the name of the series, its value in each run at a time and, with `hasMeans`, its mean so far. */
export function legendOf(runs, quantity, time, { hasMeans = false } = {}) {
  const parts = runs.map((run) => {
    const part = element("span", "value");
    if (runs.length > 1) {
      part.title = run.name;
      part.append(element("span", `swatch ${run.color}`), element("span", "unseen", `${run.name} `));
    }
    const sample = run.sampleAt(time);
    part.append(element("b", "", fixed(run.value(quantity.key, sample), quantity.decimals)));
    if (hasMeans) {
      part.append(element("span", "faint mean", ` mean ${fixed(run.meanUpTo(quantity.key, sample), quantity.decimals)}`));
    }
    return part;
  });
  return [element("span", "", caption(quantity)), ...parts];
}

/** Ranges of values by the key of their series. */
const ranges = new Map();

/** The least and the greatest value of a series over all runs; the range includes 0. */
function valueRange(runs, key) {
  if (!ranges.has(key)) {
    let [low, high] = [0, 0];
    for (const run of runs) {
      const column = run.columns.get(key);
      for (let k = 0; column && k < column.length; k += 1) {
        low = Math.min(low, column.at(k));
        high = Math.max(high, column.at(k));
      }
    }
    ranges.set(key, [low, high > low ? high : low + 1]);
  }
  return ranges.get(key);
}

/** About `count` round numbers from `low` to `high`. */
export function ticks(low, high, count, roundStep = roundNumber) {
  const step = roundStep((high - low) / count);
  const first = Math.ceil(low / step - 1e-9);
  const last = Math.floor(high / step + 1e-9);
  return Array.from({ length: last - first + 1 }, (_, k) => (first + k) * step);
}

/** The least round number of seconds, minutes or hours that is at least `least` seconds. */
export function timeStep(least) {
  const steps = [1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600];
  return least < 1 ? roundNumber(least) : steps.find((step) => step >= least) ?? 3600 * roundNumber(least / 3600);
}

function drawLine(chart, context, run, column, color) {
  const [first, last] = [run.sampleAt(chart.from), run.sampleAt(chart.to)];
  context.save();
  context.beginPath();
  context.rect(EDGE.left, 0, chart.width - EDGE.left - EDGE.right, chart.height);
  context.clip();
  context.strokeStyle = color;
  context.lineWidth = 1.8;
  context.lineJoin = "round";
  context.beginPath();
  for (let k = first; k <= Math.min(last + 1, run.length - 1); k += 1) {
    context.lineTo(chart.xOf(run.time[k]), chart.yOf(column.at(k)));
  }
  context.stroke();
  context.restore();
}

/** Draws, for each column of pixels, the range of its samples in a pale color, and their mean. */
function drawBand(chart, context, run, column, color) {
  const right = Math.min(chart.xOf(run.time.at(-1)), chart.width - EDGE.right);
  const means = [];
  context.fillStyle = color;
  context.globalAlpha = 0.25;
  let k = run.sampleAt(chart.from);
  for (let x = EDGE.left; x < right; x += 1) {
    const pixelEnd = chart.timeAt(x + 1);
    let [low, high, sum, count] = [Infinity, -Infinity, 0, 0];
    for (; k < run.length && run.time[k] < pixelEnd; k += 1) {
      const value = column.at(k);
      low = Math.min(low, value);
      high = Math.max(high, value);
      sum += value;
      count += 1;
    }
    if (count > 0) {
      context.fillRect(x, chart.yOf(high), 1, Math.max(chart.yOf(low) - chart.yOf(high), 1));
      means.push([x + 0.5, chart.yOf(sum / count)]);
    }
  }
  context.globalAlpha = 1;
  context.strokeStyle = color;
  context.lineWidth = 1.4;
  context.lineJoin = "round";
  context.beginPath();
  for (const point of means) {
    context.lineTo(...point);
  }
  context.stroke();
}
