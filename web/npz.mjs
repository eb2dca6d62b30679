// Named arrays in an .npz file: a zip of .npy entries. Nothing that is read is executed.

/** Largest sum of the arrays of a file that is read, in bytes. */
const MOST_BYTES = 1 << 29;
/** Largest number of letters that are converted at once. */
const PART = 4096;

/** The bytes of an uncompressed file of arrays, given as `{name: {shape, descr, bytes}}`. */
export function writeNpz(arrays) {
  const [parts, directory] = [[], []];
  let offset = 0;
  const names = Object.keys(arrays);
  for (const name of names) {
    const entry = npyOf(arrays[name]);
    const path = new TextEncoder().encode(`${name}.npy`);
    // The fields that a file's own header and its entry in the directory share.
    const shared = new DataView(new ArrayBuffer(26));
    shared.setUint16(0, 20, true); // ZIP 2.0
    shared.setUint16(8, 33, true); // 1 January 1980: no clock in the file
    shared.setUint32(10, crc32(entry), true);
    shared.setUint32(14, entry.length, true); // packed
    shared.setUint32(18, entry.length, true); // unpacked
    shared.setUint16(22, path.length, true);
    const local = [Uint8Array.of(80, 75, 3, 4), new Uint8Array(shared.buffer), path];
    const location = new DataView(new ArrayBuffer(14));
    location.setUint32(10, offset, true);
    directory.push(Uint8Array.of(80, 75, 1, 2, 20, 0), new Uint8Array(shared.buffer), new Uint8Array(location.buffer), path);
    parts.push(...local, entry);
    offset += 30 + path.length + entry.length;
  }
  const size = directory.reduce((sum, part) => sum + part.length, 0);
  const end = new DataView(new ArrayBuffer(22));
  end.setUint32(0, 0x06054b50, true);
  end.setUint16(8, names.length, true);
  end.setUint16(10, names.length, true);
  end.setUint32(12, size, true);
  end.setUint32(16, offset, true);
  return joined([...parts, ...directory, new Uint8Array(end.buffer)]);
}

function joined(parts) {
  const bytes = new Uint8Array(parts.reduce((sum, part) => sum + part.length, 0));
  let offset = 0;
  for (const part of parts) {
    bytes.set(part, offset);
    offset += part.length;
  }
  return bytes;
}

function npyOf({ shape, descr, bytes }) {
  const sizes = shape.length === 1 ? `(${shape[0]},)` : `(${shape.join(", ")})`;
  const header = `{'descr': '${descr}', 'fortran_order': False, 'shape': ${sizes}, }`;
  const padded = `${header.padEnd(Math.ceil((11 + header.length) / 64) * 64 - 11)}\n`;
  const start = Uint8Array.of(0x93, 78, 85, 77, 80, 89, 1, 0, padded.length & 255, padded.length >> 8);
  return joined([start, new TextEncoder().encode(padded), bytes]);
}

/** Arrays of numbers, booleans or strings for `writeNpz`. */
export const array = {
  reals: (values, shape) => ({ shape, descr: "<f8", bytes: new Uint8Array(Float64Array.from(values).buffer) }),
  flags: (values, shape) => ({ shape, descr: "|b1", bytes: Uint8Array.from(values, Number) }),
  whole: (value) => ({ shape: [], descr: "<u8", bytes: new Uint8Array(BigUint64Array.of(BigInt(value)).buffer) }),
  texts: (values, shape, least = 1) => {
    const size = values.reduce((most, text) => Math.max(most, text.length), least);
    const letters = new Uint32Array(size * values.length);
    values.forEach((text, k) => { letters.set([...text].map((letter) => letter.codePointAt(0)), k * size); });
    return { shape, descr: `<U${size}`, bytes: new Uint8Array(letters.buffer) };
  },
};

/** The arrays of a file: `{name: {shape, descr, values}}`, values flat: numbers, booleans as numbers, or strings. */
export async function readNpz(buffer) {
  const bytes = new Uint8Array(buffer);
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.length);
  const arrays = {};
  let total = 0;
  for (const { name, start, packed, size, method, checksum } of entries(view)) {
    total += size;
    if (total > MOST_BYTES) {
      throw new Error("it holds more than this page shows");
    }
    const content = bytes.subarray(start, start + packed);
    const entry = method === 0 ? content : await inflated(content, size);
    if (entry.length !== size || crc32(entry) !== checksum) {
      throw new Error(`Bad CRC-32 for file '${name}'`);
    }
    const arrayName = name.replace(/\.npy$/, "");
    if (Object.hasOwn(arrays, arrayName)) {
      throw new Error(`it holds '${arrayName}' twice`);
    }
    arrays[arrayName] = readNpy(entry);
  }
  return arrays;
}

/** The entries of a zip file's directory. */
function* entries(view) {
  let end = view.byteLength - 22;
  while (end >= 0 && end > view.byteLength - 70_000 && view.getUint32(end, true) !== 0x06054b50) {
    end -= 1;
  }
  if (end < 0 || view.getUint32(end, true) !== 0x06054b50) {
    throw new Error("its end is missing");
  }
  const [count, size, first] = [view.getUint16(end + 10, true), view.getUint32(end + 12, true), view.getUint32(end + 16, true)];
  let offset = first;
  for (let k = 0; k < count; k += 1) {
    const entry = directoryEntry(view, offset);
    yield entry;
    offset = entry.next;
  }
  if (offset !== end || first + size !== end) {
    throw new Error("Bad magic number for central directory");
  }
}

/** The entry of a file in the directory, which must agree with the file's own header. */
function directoryEntry(view, offset) {
  if (view.getUint32(offset, true) !== 0x02014b50) {
    throw new Error("Bad magic number for central directory");
  }
  const [version, flags, method] = [6, 8, 10].map((at) => view.getUint16(offset + at, true));
  const [checksum, packed, size, local] = [16, 20, 24, 42].map((at) => view.getUint32(offset + at, true));
  const [length, extra, comment] = [28, 30, 32].map((at) => view.getUint16(offset + at, true));
  const nameAt = (at, long) => new TextDecoder().decode(new Uint8Array(view.buffer, view.byteOffset + at, long));
  const name = nameAt(offset + 46, length);
  // Of the flags only "lengths follow" and "names are UTF-8" may be set.
  const isKnown = [0, 8].includes(method) && version <= 63 && (flags & ~0x808) === 0 && packed !== 0xffffffff;
  if (!isKnown || view.getUint16(offset + 34, true) !== 0) {
    throw new Error(`${name} is packed in an unknown way`);
  }
  const localLength = view.getUint16(local + 26, true);
  if (view.getUint32(local, true) !== 0x04034b50) {
    throw new Error("Bad magic number for file header");
  }
  if (nameAt(local + 30, localLength) !== name || view.getUint16(local + 8, true) !== method || (view.getUint16(local + 6, true) & ~0x808) !== 0) {
    throw new Error(`File name in directory '${name}' and header '${nameAt(local + 30, localLength)}' differ.`);
  }
  const start = local + 30 + localLength + view.getUint16(local + 28, true);
  return { name, start, packed, size, method, checksum, next: offset + 46 + length + extra + comment };
}

async function inflated(bytes, most) {
  const reader = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw")).getReader();
  const parts = [];
  let length = 0;
  for (let next = await reader.read(); !next.done; next = await reader.read()) {
    length += next.value.length;
    if (length > most) {
      throw new Error("an entry holds more than it says");
    }
    parts.push(next.value);
  }
  return joined(parts);
}

const READERS = {
  "<f8": (bytes) => new Float64Array(bytes),
  "<f4": (bytes) => new Float32Array(bytes),
  "<i8": (bytes) => Float64Array.from(new BigInt64Array(bytes), Number),
  "<i4": (bytes) => new Int32Array(bytes),
  "<u4": (bytes) => new Uint32Array(bytes),
  "<u8": (bytes) => Array.from(new BigUint64Array(bytes), String),
  "|b1": (bytes) => new Uint8Array(bytes),
  "|u1": (bytes) => new Uint8Array(bytes),
};

function readNpy(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.length);
  if (bytes.length < 12 || bytes[0] !== 0x93 || ![1, 2].includes(bytes[6])) {
    throw new Error("an entry is not an array");
  }
  const start = bytes[6] === 1 ? 10 : 12;
  const length = bytes[6] === 1 ? view.getUint16(8, true) : view.getUint32(8, true);
  const header = new TextDecoder().decode(bytes.subarray(start, start + length));
  const descr = /'descr':\s*'([^']+)'/.exec(header)?.[1] ?? "";
  const shape = (/'shape':\s*\(([^)]*)\)/.exec(header)?.[1] ?? "").split(",").map((size) => size.trim()).filter(Boolean).map(Number);
  const count = shape.reduce((product, size) => product * size, 1);
  const content = bytes.slice(start + length).buffer;
  const width = /^<U(\d+)$/.exec(descr)?.[1];
  if (width === undefined && !Object.hasOwn(READERS, descr)) {
    throw new Error(`an array of ${descr.slice(0, 20) || "an unknown kind"} is not accepted`);
  }
  const values = width === undefined ? READERS[descr](content) : textsOf(content, Number(width));
  if (values.length !== count) {
    throw new Error("an array has a shape that does not match its size");
  }
  const isByColumns = /'fortran_order':\s*True/.test(header) && shape.length > 1;
  return { shape, descr, values: isByColumns ? rowByRow(values, shape) : values };
}

/** Numbers of an array that was stored with its first index as the fastest one. */
function rowByRow(values, shape) {
  const strides = shape.map((_, axis) => shape.slice(0, axis).reduce((product, size) => product * size, 1));
  return values.map((_, k) => {
    let [place, rest] = [0, k];
    for (let axis = shape.length - 1; axis >= 0; axis -= 1) {
      place += strides[axis] * (rest % shape[axis]);
      rest = Math.floor(rest / shape[axis]);
    }
    return values[place];
  });
}

function textsOf(content, width) {
  const letters = new Uint32Array(content);
  return Array.from({ length: width === 0 ? 0 : letters.length / width }, (_, k) => {
    // As in NumPy, only zeros at the end are padding.
    const points = letters.subarray(k * width, (k + 1) * width);
    const end = points.findLastIndex((point) => point > 0) + 1;
    if (points.some((point) => point > 0x10ffff)) {
      throw new Error("an array holds codes that are no characters");
    }
    // Converted in parts, since the number of arguments of a call is limited.
    const parts = Array.from({ length: Math.ceil(end / PART) }, (_, part) => String.fromCodePoint(...points.subarray(part * PART, Math.min((part + 1) * PART, end))));
    return parts.join("");
  });
}

let table = null;

function crc32(bytes) {
  table ??= Uint32Array.from({ length: 256 }, (_, k) => {
    let value = k;
    for (let bit = 0; bit < 8; bit += 1) {
      value = value & 1 ? (value >>> 1) ^ 0xedb88320 : value >>> 1;
    }
    return value;
  });
  let sum = 0xffffffff;
  for (const byte of bytes) {
    sum = table[(sum ^ byte) & 255] ^ (sum >>> 8);
  }
  return (sum ^ 0xffffffff) >>> 0;
}
