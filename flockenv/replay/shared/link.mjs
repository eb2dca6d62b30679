// Links of both pages: sentences for ignored parts, and an address that is kept up to date.

/** Least time between two changes of the address, in ms: browsers refuse more than some 100 in half a minute. */
const ADDRESS_INTERVAL = 1000;
const MOST_LETTERS = 40;

/** A part of a link, shortened for a sentence. */
export const cut = (text) => (text.length > MOST_LETTERS ? `${text.slice(0, MOST_LETTERS)}…` : text);

/** Says that a part of a link is ignored, and why. */
export const ignoredPart = (key, text, why) => `The link's ${cut(key)}=${cut(text)} is ignored: ${why}.`;

/** Updates the page's address, at most once per interval. */
export class LinkWriter {
  #link;
  #timer = null;

  /** `link` returns the new fragment, or null for no change. */
  constructor(link) {
    this.#link = link;
  }

  /** Requests an update. */
  write() {
    this.#timer ??= setTimeout(() => {
      this.#timer = null;
      const link = this.#link();
      // A page inside another one, such as a notebook, has no address.
      if (link === null || location.protocol === "about:") {
        return;
      }
      try {
        history.replaceState(null, "", link);
      } catch {
        // In a frame without an origin the address stays as it is.
      }
    }, ADDRESS_INTERVAL);
  }
}
