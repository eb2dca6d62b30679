// Starts the page: unpacks its runs, shows them at the moment of the largest change, and plays.

import { unpack } from "./packing.mjs";
import { Player } from "./player.mjs";
import { Run } from "./shared/run.mjs";

async function start() {
  const { runs: descriptions, quantities, moment } = JSON.parse(document.getElementById("data").textContent);
  const runs = await Promise.all(descriptions.map(async (description) => new Run(description, await unpack(description.data))));
  window.player = new Player(runs, quantities, moment.time_s);
  const thinned = Math.max(...runs.map((run) => run.every));
  document.getElementById("note").textContent =
    `${moment.words} ${thinned > 1 ? `Of ${thinned} samples one is shown. ` : ""}` +
    "Between samples boats are drawn on straight lines. Click a boat to keep its numbers.";
  document.body.dataset.ready = "true";
  if (!matchMedia("(prefers-reduced-motion: reduce)").matches) {
    window.player.toggle();
  }
}

start().catch((error) => {
  document.getElementById("note").textContent = `This page is damaged, or the browser too old: ${error.message}`;
  document.body.dataset.ready = "failed";
});
