// Playing and pausing: the time that passes between pictures, and the button that shows whether the page plays.

/** A page in the background gets no frames. Longer pauses than this, in ms, count as this long, so that it continues where it was. */
const LONGEST_FRAME = 250;

export class Transport {
  playing = false;
  #button;
  #tick;
  #before = 0;

  /** `tick` gets the seconds that passed, and the time of the frame in ms. */
  constructor(button, tick) {
    this.#button = button;
    this.#tick = tick;
  }

  play() {
    if (!this.playing) {
      this.#set(true);
      this.rest();
      requestAnimationFrame((now) => this.#frame(now));
    }
  }

  pause() {
    this.#set(false);
  }

  /** Restarts the clock, so that the time until now does not count. */
  rest() {
    this.#before = performance.now();
  }

  #set(playing) {
    this.playing = playing;
    this.#button.classList.toggle("playing", playing);
    this.#button.setAttribute("aria-label", playing ? "Pause" : "Play");
  }

  #frame(now) {
    if (!this.playing) {
      return;
    }
    const passed = Math.min(Math.max(now - this.#before, 0), LONGEST_FRAME) / 1000;
    this.#before = now;
    this.#tick(passed, now);
    requestAnimationFrame((next) => this.#frame(next));
  }
}
