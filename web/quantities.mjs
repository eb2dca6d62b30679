// The quantities of a flock, and what their values mean.

/** Meanings of values of the quantities that are shown in large type. */
export const MEANINGS = {
  psi_o: "1: all boats keep one angle to the wall, circling or jammed",
  rotation: "1: all circle clockwise; −1: counter-clockwise; 0: a jam",
  signed_order: "1: all others circle with the leaders; −1: against them",
};

/** The quantities of a sample, from the simulator's description, as charts and tables have them. */
export function quantitiesOf({ quantities }) {
  return quantities.filter(({ kind }) => kind !== "structure").map(({ name, label, symbol, ...rest }) => ({
    ...rest, key: name, decimals: 2, words: label.replace(/^[^,]*/, (word) => `${word} ${symbol}`.trim()).replace("_o", "ₒ"),
  }));
}
