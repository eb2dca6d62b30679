// The rudder that a visitor holds: a thumb, and the arrow keys wherever the focus is.

/** What takes arrow keys for itself: text, and a list of keys that is open. */
const KEEPS_ARROWS = "textarea, input[type='text'], input[type='number'], [contenteditable], dialog[open]";
const ARROWS = ["ArrowLeft", "ArrowRight"];

export class Rudder {
  /** From −1 to 1, positive to the left: counter-clockwise for a boat that moves forward. */
  value = 0;
  #held = new Set();
  #thumb;
  #isYours;

  /** `isYours`: whether there is a boat that the visitor steers. */
  constructor(thumb, isYours) {
    this.#thumb = thumb;
    this.#isYours = isYours;
    thumb.addEventListener("input", () => { this.value = -Number(thumb.value); });
    for (const name of ["pointerup", "pointercancel", "blur"]) {
      thumb.addEventListener(name, () => this.release());
    }
    window.addEventListener("blur", () => this.release());
    // Before whatever has the focus, such as a choice that an arrow would change.
    for (const name of ["keydown", "keyup"]) {
      document.addEventListener(name, (event) => this.#key(event), { capture: true });
    }
  }

  /** Amidships. */
  release() {
    this.#held.clear();
    this.#show(0);
  }

  #key(event) {
    const isPress = event.type === "keydown";
    if (!ARROWS.includes(event.key) || !this.#isYours() || (isPress && isKept(event))) {
      return;
    }
    event.preventDefault();
    event.stopPropagation();
    if (isPress && document.activeElement !== this.#thumb) {
      this.#thumb.focus({ preventScroll: true });
    }
    this.#held[isPress ? "add" : "delete"](event.key);
    this.#show(Number(this.#held.has("ArrowLeft")) - Number(this.#held.has("ArrowRight")));
  }

  #show(value) {
    this.value = value;
    this.#thumb.value = -value;
  }
}

function isKept(event) {
  return event.ctrlKey || event.metaKey || event.altKey || event.target.closest?.(KEEPS_ARROWS) || document.querySelector("dialog[open]");
}

/** Says how a game stands: `yours` and `law`, mean order towards the target; null before the end. */
export function verdict(yours, law, seconds, end) {
  if (seconds < end) {
    return null;
  }
  const [first, second] = [yours, law].map((each) => each.toFixed(2));
  if (first === second) {
    return `A draw: you and the law both reach ${signed(first)}.`;
  }
  return Number(first) > Number(second) ?
    `You win: your order towards the target is ${signed(first)}, the law's ${signed(second)}.` :
    `The law wins: its order towards the target is ${signed(second)}, yours ${signed(first)}.`;
}

const signed = (text) => (Number(text) > 0 ? `+${text}` : text.replace("-", "−"));
