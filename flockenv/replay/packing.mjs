// Reverses packing.py: base64, gzip, planes of bytes, zigzag encoding, differences along time.

/** One series: its number is `values[channel * length + sample] * quantum`. */
export class Column {
  constructor(header, values) {
    this.length = header.length;
    this.channels = header.channels;
    this.quantum = header.quantum;
    this.values = values;
  }

  at(sample, channel = 0) {
    return this.values[channel * this.length + sample] * this.quantum;
  }
}

/** Returns the series of a run by name. */
export async function unpack(text) {
  const bytes = await gunzip(Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)));
  const end = 4 + new DataView(bytes.buffer).getUint32(0, true);
  const headers = JSON.parse(new TextDecoder().decode(bytes.subarray(4, end)));
  const columns = new Map();
  let offset = end;
  for (const header of headers) {
    const count = header.length * header.channels;
    const planes = bytes.subarray(offset, offset + count * header.planes);
    offset += planes.length;
    columns.set(header.name, new Column(header, decoded(planes, count, header)));
  }
  return columns;
}

async function gunzip(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Decodes planes of bytes to `count` numbers in quanta, channel after channel. */
function decoded(planes, count, header) {
  const values = new Int32Array(count);
  for (let k = 0; k < count; k += 1) {
    let zigzag = 0;
    for (let plane = 0; plane < header.planes; plane += 1) {
      zigzag |= planes[plane * count + k] << (8 * plane);
    }
    values[k] = (zigzag >>> 1) ^ -(zigzag & 1);
  }
  for (let round = 0; round < header.differences; round += 1) {
    for (let start = 0; start < count; start += header.length) {
      for (let k = start + 1; k < start + header.length; k += 1) {
        values[k] += values[k - 1];
      }
    }
  }
  return values;
}
