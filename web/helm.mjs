// The heading that a visitor chooses for the leaders, by a slider's thumb or by the arrow keys,
// wherever the focus is.

/** Elements in which arrow keys keep their meaning: text, and the open list of keys. */
const KEEPS_ARROWS = "textarea, input[type='text'], input[type='number'], [contenteditable], dialog[open]";
/** The turn of each key, in degrees clockwise. */
const TURNS = { ArrowLeft: -15, ArrowRight: 15 };

export class Helm {
  #thumb;
  #words;
  #isYours;
  #onTurn;

  /** `words`: element that shows the heading in words; `isYours`: whether the visitor steers any boats; `onTurn`: called after each turn. */
  constructor(thumb, words, isYours, onTurn) {
    this.#thumb = thumb;
    this.#words = words;
    this.#isYours = isYours;
    this.#onTurn = onTurn;
    thumb.addEventListener("input", () => this.#turn(Number(thumb.value)));
    // Handled before the focused element gets the key: an arrow would change a choice, for example.
    document.addEventListener("keydown", (event) => this.#key(event), { capture: true });
    this.center();
  }

  /** The heading from −1 to 1: the angle clockwise from outward, divided by half a turn. */
  get value() {
    return Number(this.#thumb.value) / 180;
  }

  /** Sets the heading straight at the wall, as at the start of a round. */
  center() {
    this.#show(0);
  }

  #key(event) {
    if (!Object.hasOwn(TURNS, event.key) || !this.#isYours() || keepsArrow(event)) {
      return;
    }
    event.preventDefault();
    event.stopPropagation();
    this.#thumb.focus({ preventScroll: true });
    this.#turn(turned(Number(this.#thumb.value), TURNS[event.key]));
  }

  #turn(degrees) {
    this.#show(degrees);
    this.#onTurn();
  }

  #show(degrees) {
    this.#thumb.value = degrees;
    this.#words.textContent = headingWords(degrees);
    this.#thumb.setAttribute("aria-valuetext", this.#words.textContent);
  }
}

/** A heading after a turn, both in degrees; the result is wrapped to ±180. */
export function turned(degrees, by) {
  const next = degrees + by;
  return next > 180 || next < -180 ? next - 360 * Math.sign(next) : next;
}

/** Whether a key is not for the helm. */
function keepsArrow(event) {
  return event.ctrlKey || event.metaKey || event.altKey || event.target.closest?.(KEEPS_ARROWS) || document.querySelector("dialog[open]");
}

/** A heading in words, by its degrees clockwise from outward. */
export function headingWords(degrees) {
  const [angle, direction] = [Math.abs(degrees), degrees > 0 ? "clockwise" : "counter-clockwise"];
  if (angle === 0 || angle === 180) {
    return angle === 0 ? "straight at the wall" : "straight inward";
  }
  const lean = 90 - angle;
  return lean === 0 ? direction : `${direction}, ${Math.abs(lean)}° ${lean > 0 ? "outward" : "inward"}`;
}
