// Links of both pages: sentences for parts that cannot be followed, and an address that follows the page.

/** Least time between two changes of the address, in ms: browsers refuse more than some 100 in half a minute. */
const EVERY = 1000;
const SHOWN = 40;

/** A part of a link, cut to the length that a sentence may have. */
export const cut = (text) => (text.length > SHOWN ? `${text.slice(0, SHOWN)}…` : text);

/** Says that a part of a link is ignored, and why. */
export const ignoredPart = (key, text, why) => `The link's ${cut(key)}=${cut(text)} is ignored: ${why}.`;

/** Updates the page's address soon after a request. */
export class LinkWriter {
  #link;
  #due = null;

  /** `link` returns the new fragment, or null for no change. */
  constructor(link) {
    this.#link = link;
  }

  write() {
    this.#due ??= setTimeout(() => {
      this.#due = null;
      const link = this.#link();
      // A page inside another one, such as a notebook, has no address itself.
      if (link === null || location.protocol === "about:") {
        return;
      }
      try {
        history.replaceState(null, "", link);
      } catch {
        // In a frame without an origin the address stays as it is.
      }
    }, EVERY);
  }
}
