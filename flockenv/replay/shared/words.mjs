// Numbers, angles and times as text, and elements that hold text.

export const byId = (id) => document.getElementById(id);

/** An element with a class and text. */
export function element(kind, className = "", text = "") {
  const node = document.createElement(kind);
  node.className = className;
  node.textContent = text;
  return node;
}

/** A number with a real minus sign; zero has no sign, and a missing number is a dash. */
export function fixed(value, decimals) {
  if (value === undefined || Number.isNaN(value)) {
    return "–";
  }
  const text = value.toFixed(decimals);
  if (Number(text) === 0) {
    return text.replace("-", "");
  }
  return text.replace("-", "−");
}

/** As `fixed`, and a positive number has a plus sign. */
export function withSign(value, decimals) {
  const text = fixed(value, decimals);
  return Number(text) > 0 ? `+${text}` : text;
}

/** A number in its shortest form, with a real minus sign. */
export function plain(value) {
  return String(Number(value.toPrecision(6))).replace("-", "−");
}

/** An angle wrapped to ±π. */
export function wrapped(angle) {
  return Math.atan2(Math.sin(angle), Math.cos(angle));
}

/** Seconds, or minutes and seconds, for an axis. */
export function clockText(time) {
  const seconds = Math.round(time);
  return seconds < 60 ? `${plain(time)} s` : `${Math.floor(seconds / 60)}:${String(seconds % 60).padStart(2, "0")}`;
}

/** A quantity's words with its unit. */
export function caption({ words, unit }) {
  return unit ? `${words} (${unit})` : words;
}

/** The least of …, 1, 2, 5, 10, 20, … that is at least `least`. */
export function roundNumber(least) {
  const decade = 10 ** Math.floor(Math.log10(least));
  return [1, 2, 5, 10].find((step) => step * decade >= least * (1 - 1e-9)) * decade;
}
