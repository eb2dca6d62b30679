// The part of the page's address that selects what is shown: `#t=240&speed=8`.

import { ignoredPart } from "./shared/link.mjs";

/**
 * Reads a fragment. Returns `time` in s and `speed`, each null if it is missing, and `ignored`, a sentence for
 * each part that cannot be followed.
 */
export function readLink(fragment, { start, end, speeds }) {
  const requested = { time: null, speed: null, ignored: [] };
  for (const [key, text] of new URLSearchParams(fragment.replace(/^#/, ""))) {
    const value = text.trim() === "" ? NaN : Number(text);
    // A time in a link is rounded up to a millisecond.
    if (key === "t" && value >= start && value <= end + 1e-3) {
      requested.time = value;
    } else if (key === "speed" && speeds.includes(value)) {
      requested.speed = value;
    } else {
      requested.ignored.push(refusal(key, text, { start, end, speeds }));
    }
  }
  return requested;
}

function refusal(key, text, { start, end, speeds }) {
  const accepted = {
    t: `t is a time from ${start} to ${end} s`,
    speed: `speed is one of ${speeds.join(", ")}`,
  };
  return ignoredPart(key, text, accepted[key] ?? "a link may hold t and speed");
}

/** The fragment for a time in s and a speed. The time is rounded up: just before a sample, another one would be shown. */
export function linkTo(time, speed) {
  return `#t=${Math.ceil(1000 * time - 1e-3) / 1000}&speed=${speed}`;
}
