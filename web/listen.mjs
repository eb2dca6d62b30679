// Actions of the page's buttons, keys, files and links.

import { colorKey } from "../flockenv/replay/shared/panel.mjs";
import { colors } from "../flockenv/replay/shared/scene.mjs";
import { byId, element, fixed } from "../flockenv/replay/shared/words.mjs";
import { linkOf } from "./follow.mjs";
import { lessonLinks } from "./lessons.mjs";
import { SPEEDS } from "./request.mjs";
import { derivedOf, download, recordingOf, runOfFile } from "./share.mjs";
import { Training } from "./training.mjs";

/** Time in ms for which a button says that it copied. */
const COPIED = 2000;

/** Connects a page to the visitor's buttons, keys, files and links. */
export function listen(page) {
  byId("speed").append(...SPEEDS.map((speed) => new Option(speed === "max" ? "as fast as it goes" : `${speed} ×`, speed)));
  byId("color-key").append(...colorKey());
  byId("lessons").append(element("span", "faint", "Lessons:"), ...lessonLinks());
  buttons(page);
  keys(page);
  files(page);
  page.training = trainingOf(page);
  document.addEventListener("click", (event) => {
    // A link to the flock that is already shown restarts it.
    const link = event.target.closest?.("a[href^='#']");
    if (link && link.getAttribute("href") === location.hash) {
      page.follow(location.hash);
    }
  });
  // Uses the event's address, since the page may have changed its own in the meantime.
  window.addEventListener("hashchange", ({ newURL }) => page.follow(new URL(newURL).hash));
  new ResizeObserver(() => { page.show(); page.training.draw(); }).observe(byId("runs"));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    page.view.palette = colors();
    page.show();
    page.training.draw();
  });
}

function buttons(page) {
  byId("play").addEventListener("click", () => page.toggle());
  byId("again").addEventListener("click", () => page.again());
  byId("another").addEventListener("click", () => page.restart(String(Math.floor(Math.random() * 1e6))));
  byId("help").addEventListener("click", () => byId("keys").showModal());
  byId("speed").addEventListener("change", () => page.remember("speed", byId("speed").value));
  byId("forces").addEventListener("change", () => page.remember("forces", byId("forces").checked ? "1" : "0"));
  byId("colors").addEventListener("change", () => page.remember("colors", byId("colors").value));
  byId("boat").addEventListener("change", () => page.pin(byId("boat").value === "" ? null : Number(byId("boat").value)));
  byId("scrub").addEventListener("input", () => page.seek(Number(byId("scrub").value)));
  // Plots that were folded had no size, and are drawn when they open.
  for (const name of ["more", "about-flock"]) {
    byId(name).addEventListener("toggle", () => page.show());
  }
  for (const button of document.querySelectorAll("[data-copies]")) {
    const report = element("span", "unseen");
    report.setAttribute("role", "status");
    button.after(report);
    button.addEventListener("click", () => copy(page, button, report));
  }
}

/** The page's training, connected to its buttons. */
function trainingOf(page) {
  const training = new Training(page);
  byId("train").addEventListener("click", () => training.toggle());
  byId("save-policy").addEventListener("click", () => training.save());
  byId("save-before").addEventListener("click", () => training.save(training.before));
  return training;
}

function keys(page) {
  const pinNext = (by) => {
    const { boats } = page.runs[0];
    const { pinned } = page.view;
    page.pin(pinned === null ? (by > 0 ? 0 : boats - 1) : (pinned + by + boats) % boats);
  };
  const choose = (id, value) => {
    byId(id).value = value;
    byId(id).dispatchEvent(new Event("change"));
  };
  const actions = {
    c: () => choose("colors", byId("colors").value === "role" ? "direction" : "role"),
    f: () => byId("forces").click(),
    "]": () => pinNext(1),
    "[": () => pinNext(-1),
    "?": () => byId("keys").showModal(),
    Escape: () => page.pin(null),
  };
  document.addEventListener("keydown", (event) => {
    const isTyped = event.target.closest?.("select, textarea, dialog, input[type='file']");
    if (event.ctrlKey || event.metaKey || event.altKey || isTyped) {
      return;
    }
    if (event.key === " " && !event.target.closest?.("button, a, summary, input[type='checkbox']")) {
      event.preventDefault();
      page.toggle();
    } else if (Object.hasOwn(actions, event.key)) {
      event.preventDefault();
      actions[event.key]();
    }
  });
}

function files(page) {
  byId("save").addEventListener("click", () => save(page));
  byId("open").addEventListener("change", () => {
    const file = byId("open").files[0];
    // Otherwise choosing the same file again would be no change.
    byId("open").value = "";
    open(page, file);
  });
  document.addEventListener("dragover", (event) => event.preventDefault());
  document.addEventListener("drop", (event) => {
    event.preventDefault();
    open(page, event.dataTransfer?.files[0]);
  });
}

/** Copies, and says so in the button, whose position and width stay the same, and in `report` for screen readers. */
async function copy(page, button, report) {
  const { copies } = button.dataset;
  const text = copies === "address" ? new URL(linkOf(page.flocks, page.other, page.time), location.href).href : byId(copies).value;
  report.textContent = "";
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    report.className = "";
    report.textContent = ` The browser does not let this page copy; here it is: ${text}`;
    return;
  }
  report.className = "unseen";
  report.textContent = "Copied.";
  if (!button.style.minWidth) {
    const words = button.textContent;
    button.style.minWidth = `${button.getBoundingClientRect().width}px`;
    button.textContent = "copied";
    setTimeout(() => { Object.assign(button, { textContent: words }).style.minWidth = ""; }, COPIED);
  }
}

/** Saves the recording through the browser. */
function save(page) {
  const [run] = page.runs;
  const recorded = page.quantities.filter(({ kind }) => kind === "recorded").map(({ key }) => key);
  const { policy, statistics } = page.flocks;
  const bytes = recordingOf(run, { ...page.about, recorded, statistics, policy });
  download(bytes, "flock.npz");
  page.say(`The recording holds ${fixed(run.time[run.firstSinceChange], 1)} to ${fixed(run.end, 1)} s; flockenv.Recording.load reads it.`);
}

/** Plays a recording's file. */
async function open(page, file) {
  if (!file) {
    return;
  }
  const { flocks, quantities, simulator } = page;
  const { phases, series, statistics } = flocks;
  const about = { format: page.about.format, phases, series, statistics, quantities };
  try {
    const run = await runOfFile(file, about, {
      check: async (request) => (await simulator.ask("check", { request })).values,
      describe: (answer, otherFields) => flocks.runDescription(answer, otherFields),
      derive: async (arrays, description) => (await simulator.ask("derive", derivedOf(arrays, description, flocks.series))).series,
    });
    // Wait for a flock that is changing, or running to the time of a link.
    while (page.changing && !page.broken) {
      await new Promise((resolve) => { setTimeout(resolve, 50); });
    }
    page.playback.begin(run);
    page.say(`${file.name} waits for “play”. “Again” returns to the flock where it was.`);
  } catch (error) {
    page.say(`${file.name.slice(0, 60)} ${error.message}.`);
  }
}
