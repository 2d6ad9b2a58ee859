// Reading surface.bin: the outer surface of a body at all recorded pressures. The bytes are described in
// solver/post/recording.h.

const MARK = 'PNLSURF1';

async function inflate(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// Numbers of four bytes, each as its difference to the one before.
export function readNumbers(bytes, count) {
  const numbers = new Uint32Array(count);
  let last = 0;
  for (let k = 0; k < count; k++) {
    last += bytes[k] + (bytes[count + k] << 8) + (bytes[2 * count + k] << 16) + (bytes[3 * count + k] << 24);
    numbers[k] = last;
  }
  return numbers;
}

// The states of one channel: rows of numbers 0 to 65535.
function readRows(bytes, points, states) {
  const rows = [];
  for (let s = 0; s < states; s++) {
    const from = 2 * points * s;
    const row = new Uint16Array(points);
    const [one, two] = [rows[s - 1], rows[s - 2]];
    for (let p = 0; p < points; p++) {
      const difference = bytes[from + p] + (bytes[from + points + p] << 8);
      let expected = s === 0 ? row[p - 1] || 0 : one[p];
      if (two) {
        expected = 2 * one[p] - two[p];
      }
      row[p] = difference + expected;
    }
    rows.push(row);
  }
  return rows;
}

// Places and fields of so many points in all states, and how many bytes they took: { places, fields, size }.
export function readChannels(head, bytes, points, states) {
  const channels = [0, 1, 2].map((i) => ({ name: 'xyz'[i], unit: 'mm', low: head.low_mm[i], high: head.high_mm[i] }))
    .concat(head.fields.map((field) => ({ ...field })));
  const size = 2 * points * states;
  channels.forEach((channel, i) => {
    channel.rows = readRows(bytes.subarray(i * size, (i + 1) * size), points, states);
  });
  return { places: channels.slice(0, 3), fields: channels.slice(3), size: channels.length * size };
}

export class Surface {
  // positions: where in what is played the states are, rising; of a load its pressures.
  constructor({ points, quads, positions, places, fields }) {
    Object.assign(this, { points, quads, positions, places, fields });
  }

  // A position as a place between two recorded states: [state, share of the next one].
  between(position) {
    const last = this.positions.length - 1;
    let state = 0;
    while (state < last - 1 && this.positions[state + 1] <= position) {
      state++;
    }
    if (last === 0) {
      return [0, 0];
    }
    const [from, to] = [this.positions[state], this.positions[state + 1]];
    return [state, Math.min(Math.max((position - from) / (to - from), 0), 1)];
  }

  // Writes the values of a channel at a position to into[start + stride * point].
  fill(channel, position, into, start = 0, stride = 1) {
    const [state, share] = this.between(position);
    const scale = (channel.high - channel.low) / 65535;
    const from = channel.rows[state];
    const to = channel.rows[Math.min(state + 1, channel.rows.length - 1)];
    for (let p = 0, at = start; p < this.points; p++, at += stride) {
      into[at] = channel.low + scale * (from[p] + share * (to[p] - from[p]));
    }
  }

  // A range that in every state all but a few points are in: at edges fields are singular.
  rangeOf(channel) {
    channel.range ||= [channel.low, channel.low + (channel.high - channel.low) / 65535
      * channel.rows.reduce((top, row) => {
        const sorted = row.slice().sort();
        return Math.max(top, sorted[Math.floor(0.998 * (sorted.length - 1))]);
      }, 0)];
    return channel.range;
  }
}

// Loads such a file as { head, bytes }; throws when there is none, or it is damaged.
export async function loadPacked(url) {
  const response = await fetch(url);
  if (!response.ok) {
    throw new Error(`The surface is not there (status ${response.status}).`);
  }
  const data = await response.arrayBuffer();
  const bytes = new Uint8Array(data);
  if (new TextDecoder().decode(bytes.subarray(0, MARK.length)) !== MARK) {
    throw new Error('This is no surface.');
  }
  const length = new DataView(data).getUint32(MARK.length, true);
  const start = MARK.length + 4;
  const head = JSON.parse(new TextDecoder().decode(bytes.subarray(start, start + length)));
  return { head, bytes: await inflate(bytes.subarray(start + length)) };
}

export async function loadSurface(url) {
  const { head, bytes } = await loadPacked(url);
  const positions = head.pressures_kPa;
  const quads = readNumbers(bytes, 4 * head.quads);
  return new Surface({ points: head.points, quads, positions,
    ...readChannels(head, bytes.subarray(16 * head.quads), head.points, positions.length) });
}
