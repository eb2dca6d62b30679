// Starts the page, or says why it cannot.

import { OPENING } from "./lessons.mjs";
import { listen } from "./listen.mjs";
import { LivePage } from "./live.mjs";
import { PAUSED, wantsLessMotion } from "./playback.mjs";
import { Simulator } from "./simulator.mjs";

const text = (id) => document.getElementById(id).textContent;

async function start() {
  const thread = new TextDecoder().decode(await globalThis.unpacked("thread"));
  const simulator = new Simulator(thread, await globalThis.unpacked("wasm"));
  const about = JSON.parse(text("about"));
  const description = await simulator.start();
  const sheet = new CSSStyleSheet();
  sheet.replaceSync(description.colors);
  document.adoptedStyleSheets = [sheet];
  window.page = new LivePage(simulator, about, description);
  listen(window.page);
  await window.page.follow(location.hash.length > 1 ? location.hash : about.opening ?? OPENING);
  document.body.dataset.ready = "true";
  if (wantsLessMotion()) {
    window.page.say(text("status") || PAUSED);
  } else if (!window.page.isHeld) {
    window.page.toggle();
  }
}

start().catch((error) => {
  document.getElementById("status").textContent = `This page cannot run here: ${error.message}.`;
  document.body.dataset.ready = "failed";
});
