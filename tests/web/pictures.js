// A canvas that notes what is drawn on it, where there is no browser.

/** Notes of calls, `[name, ...arguments]`, with the colors of then. */
export function canvas(width, height) {
  const calls = [];
  const state = {};
  const context = new Proxy(state, {
    get: (_, name) => state[name] ?? ((...words) => { calls.push({ name, words, fill: state.fillStyle, stroke: state.strokeStyle }); }),
    set: (_, name, value) => { state[name] = value; return true; },
  });
  const figure = { hidden: false };
  globalThis.window ??= { devicePixelRatio: 1 };
  globalThis.document ??= { body: {} };
  globalThis.getComputedStyle ??= () => ({ fontFamily: "sans" });
  return { calls, figure, clientWidth: width, clientHeight: height, width, height, getContext: () => context, closest: () => figure };
}
