// The page's first script: unpacks the main script, which the page's security policy allows by its digest.

/** The digits of Python's base64.b85encode, from 0 to 84. */
const DIGITS = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz!#$%&()*+-;<=>?@^_`{|}~";

/** The bytes of text in base 85: five digits are four bytes, and missing digits at the end count as the largest digit. */
function bytesOf(text) {
  const values = Object.fromEntries(Array.from(DIGITS, (digit, value) => [digit, value]));
  const view = new DataView(new ArrayBuffer(4 * Math.ceil(text.length / 5)));
  for (let start = 0; start < text.length; start += 5) {
    let number = 0;
    for (const digit of text.slice(start, start + 5).padEnd(5, "~")) {
      number = 85 * number + values[digit];
    }
    view.setUint32((4 * start) / 5, number);
  }
  return view.buffer.slice(0, Math.floor((4 * text.length) / 5));
}

/** The bytes of an element's content, which is gzip in base 85. */
globalThis.unpacked = (id) => {
  const packed = bytesOf(document.getElementById(id).textContent);
  return new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
};

const missing = ["Worker", "WebAssembly", "DecompressionStream"].find((name) => !(name in globalThis));
if (missing) {
  document.getElementById("status").textContent = `This page cannot run here: this browser has no ${missing}, in which the simulator runs.`;
  document.body.dataset.ready = "failed";
} else {
  const script = document.createElement("script");
  script.type = "module";
  script.textContent = new TextDecoder().decode(await globalThis.unpacked("packed"));
  document.body.append(script);
}
