// The map of order against noise: the flock's present order, and its orders so far.

import { fitted } from "../flockenv/replay/shared/scene.mjs";
import { plain } from "../flockenv/replay/shared/words.mjs";

const EDGE_OF_MAP = { left: 30, right: 8, top: 6, bottom: 30 };
/** The longest backward duration on the map, in s. */
export const MOST_NOISE = 3;
/** Numbers of cells of the map along the backward duration and along order. */
const CELLS = [60, 25];

export class OrderMap {
  counts = new Uint32Array(CELLS[0] * CELLS[1]);
  dot = null;
  #signature = "";
  #expected = null;

  /** `orders`: curves of [backward duration in s, mean order], each with its flock. */
  constructor(canvas, orders) {
    this.canvas = canvas;
    this.orders = orders;
  }

  /** Shows the curve that is expected of a flock, by its fields in links (null: no curve). Removes the marks if `signature`, the flock's identity, has changed. */
  expect(flock, signature) {
    const { bw_s: _, seed: __, ...fields } = flock ?? {};
    const isMatching = ({ points: _, ...curve }) => Object.entries({ n_leaders: "0", ...fields }).every(([name, value]) => String(curve[name]) === value);
    this.#expected = flock && "preset" in fields ? this.orders.find(isMatching)?.points ?? null : null;
    if (signature !== this.#signature) {
      this.#signature = signature;
      this.counts.fill(0);
      this.dot = null;
    }
    this.#hideIfEmpty();
  }

  /** Hides a map that has nothing on it. */
  #hideIfEmpty() {
    this.canvas.closest("figure").hidden = !this.#expected && !this.dot;
  }

  /** Adds the mean order of an analysis window at a backward duration in s. */
  note(noise, order) {
    this.dot = [noise, order];
    this.#hideIfEmpty();
    const cell = (fraction, count) => Math.min(Math.max(Math.floor(fraction * count), 0), count - 1);
    if (noise <= MOST_NOISE) {
      this.counts[cell(noise / MOST_NOISE, CELLS[0]) * CELLS[1] + cell(order, CELLS[1])] += 1;
    }
  }

  draw(palette) {
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight];
    if (width === 0) {
      return;
    }
    const context = fitted(this.canvas);
    const [mapWidth, mapHeight] = [width - EDGE_OF_MAP.left - EDGE_OF_MAP.right, height - EDGE_OF_MAP.top - EDGE_OF_MAP.bottom];
    const x = (noise) => EDGE_OF_MAP.left + (Math.min(noise, MOST_NOISE) / MOST_NOISE) * mapWidth;
    const y = (order) => EDGE_OF_MAP.top + (1 - order) * mapHeight;
    context.clearRect(0, 0, width, height);
    context.fillStyle = palette.water;
    context.fillRect(EDGE_OF_MAP.left, EDGE_OF_MAP.top, mapWidth, mapHeight);
    if (this.#expected) {
      context.beginPath();
      this.#expected.forEach(([noise, order]) => { context.lineTo(x(noise), y(order)); });
      context.strokeStyle = palette.faint;
      context.lineWidth = 2;
      context.stroke();
    }
    this.#cells(context, palette, mapWidth / CELLS[0], mapHeight / CELLS[1]);
    this.#scales(context, palette, mapWidth, x, y, height);
    if (this.dot) {
      context.beginPath();
      context.arc(x(this.dot[0]), y(this.dot[1]), 5, 0, 2 * Math.PI);
      context.fillStyle = palette.leader;
      context.fill();
      context.strokeStyle = palette.outline;
      context.lineWidth = 1.5;
      context.stroke();
    }
  }

  #scales(context, palette, mapWidth, x, y, height) {
    context.fillStyle = palette.faint;
    context.font = `11px ${getComputedStyle(document.body).fontFamily}`;
    context.textAlign = "center";
    for (const noise of [0, 1, 2, 3]) {
      context.fillText(plain(noise), x(noise), height - 17);
    }
    context.fillText("backward duration (s)", EDGE_OF_MAP.left + mapWidth / 2, height - 4);
    context.textAlign = "right";
    for (const order of [0, 0.5, 1]) {
      context.fillText(plain(order), EDGE_OF_MAP.left - 5, y(order) + 4);
    }
  }

  #cells(context, palette, cellWidth, cellHeight) {
    const most = Math.max(1, ...this.counts);
    context.fillStyle = palette.normal;
    this.counts.forEach((count, cell) => {
      if (count > 0) {
        const [column, row] = [Math.floor(cell / CELLS[1]), cell % CELLS[1]];
        context.globalAlpha = 0.25 + 0.75 * Math.sqrt(count / most);
        context.fillRect(EDGE_OF_MAP.left + column * cellWidth, EDGE_OF_MAP.top + (CELLS[1] - 1 - row) * cellHeight, cellWidth + 0.5, cellHeight + 0.5);
      }
    });
    context.globalAlpha = 1;
  }
}
