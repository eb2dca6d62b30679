// Playing and pausing: the time that passes between pictures, and the button that shows whether the page plays.

/** A page in the background gets no frames. A longer time than this between frames, in ms, counts as this long, so that playing goes on where it was. */
const LONGEST_FRAME = 250;

export class Transport {
  playing = false;
  #button;
  #tick;
  /** Time of the last frame in ms. */
  #lastFrame = 0;

  /** `tick` gets the seconds since the last frame, and the time of this one in ms. */
  constructor(button, tick) {
    this.#button = button;
    this.#tick = tick;
  }

  play() {
    if (!this.playing) {
      this.#set(true);
      this.restartClock();
      requestAnimationFrame((now) => this.#frame(now));
    }
  }

  pause() {
    this.#set(false);
  }

  /** Restarts the clock, so that the time until now does not count. */
  restartClock() {
    this.#lastFrame = performance.now();
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
    const passed = Math.min(Math.max(now - this.#lastFrame, 0), LONGEST_FRAME) / 1000;
    this.#lastFrame = now;
    this.#tick(passed, now);
    requestAnimationFrame((next) => this.#frame(next));
  }
}
