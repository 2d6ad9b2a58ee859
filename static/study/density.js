// Many thin lines as a picture of how densely they lie and of the mean shade of those that pass a pixel.
//
// Each line adds to two sums a pixel, so that a line can be taken out again exactly: when a selection
// changes only what changed is drawn. A line covers, in every column of pixels, the two pixels around it by
// their share (Xiaolin Wu 1991), in steep places all between its entry and its exit.

const FULL = 16; // weight of a line that covers a whole pixel

export class Density {
  constructor(width, height) {
    this.width = width;
    this.height = height;
    this.weight = new Int32Array(width * height);
    this.shade = new Int32Array(width * height);
  }

  clear() {
    this.weight.fill(0);
    this.shade.fill(0);
  }

  // A line from (x0, y0) to (x1, y1), x0 < x1 whole numbers, with a shade 0 .. 255. sign: 1 adds it, -1
  // takes it out.
  line(x0, y0, x1, y1, shade, sign) {
    const { width, height, weight, shade: shaded } = this;
    const slope = (y1 - y0) / (x1 - x0);
    const isSteep = slope > 1 || slope < -1;
    const last = height - 1;
    let y = y0;
    for (let x = x0; x < x1; x++, y += slope) {
      if (isSteep) {
        const from = Math.max(Math.round(slope > 0 ? y : y + slope), 0);
        const to = Math.min(Math.round(slope > 0 ? y + slope : y), height);
        const share = sign * Math.max(Math.round(FULL / Math.sqrt(to - from + 1)), 4);
        for (let row = from, at = from * width + x; row < to; row++, at += width) {
          weight[at] += share;
          shaded[at] += share * shade;
        }
      } else {
        const row = y < 0 ? 0 : y >= last ? last - 1 : y | 0;
        const below = sign * Math.round(FULL * Math.min(Math.max(y - row, 0), 1));
        const above = sign * FULL - below;
        const at = row * width + x;
        weight[at] += above;
        shaded[at] += above * shade;
        weight[at + width] += below;
        shaded[at + width] += below * shade;
      }
    }
  }

  // Puts the picture into pixels (RGBA): colours of the mean shades, more opaque where more lines lie.
  // tone: lines on a pixel that make it about two thirds opaque.
  paint(pixels, colours, tone) {
    const { weight, shade } = this;
    const alpha = opacities(tone);
    const most = alpha.length - 1;
    const out = new Uint32Array(pixels.data.buffer);
    for (let i = 0; i < weight.length; i++) {
      const w = weight[i];
      if (w > 0) {
        const c = 3 * ((shade[i] / w) | 0);
        out[i] = alpha[w < most ? w : most] << 24 | colours[c + 2] << 16 | colours[c + 1] << 8 | colours[c];
      } else {
        out[i] = 0;
      }
    }
  }
}

const known = new Map();

function opacities(tone) {
  if (!known.has(tone)) {
    const alpha = new Uint8Array(2048);
    for (let i = 0; i < alpha.length; i++) {
      alpha[i] = Math.round(255 * (1 - Math.exp(-i / (FULL * tone))));
    }
    known.set(tone, alpha);
  }
  return known.get(tone);
}
