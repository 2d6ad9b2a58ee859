// Many thin lines as a picture of how densely they lie and of the mean shade of those that pass a pixel.
//
// Each line adds to two sums a pixel, so that a line can be taken out again exactly: when a selection
// changes only what changed is drawn. The sums of a pixel lie side by side, and a picture is one gap between
// two axes, which fits into the caches of a processor.

const FULL = 16; // weight of a line that covers a whole pixel

export class Density {
  // isSoft: a line that is not steep covers the two pixels around it by their share (Xiaolin Wu 1991);
  // otherwise the nearest one, which is enough where lines are many.
  constructor(width, height, isSoft) {
    this.width = width;
    this.height = height;
    this.isSoft = isSoft;
    this.sums = new Int32Array(2 * width * height);
    this.pixels = new ImageData(width, height);
    this.colours = new Uint32Array(this.pixels.data.buffer);
  }

  clear() {
    this.sums.fill(0);
  }

  // A line from (0, y0) to (width, y1), 0 <= y < height - 1, with a shade 0 .. 255. sign: 1 adds it, -1
  // takes it out.
  line(y0, y1, shade, sign) {
    const slope = (y1 - y0) / this.width;
    if (slope > 1 || slope < -1) {
      this.steep(y0, 1 / slope, Math.round(y1), shade, sign * FULL);
    } else if (this.isSoft) {
      this.soft(y0, slope, shade, sign);
    } else {
      this.shallow(y0, slope, shade, sign * FULL);
    }
  }

  shallow(y0, slope, shade, weight) {
    const { sums, width } = this;
    const shaded = weight * shade;
    let y = y0 + 0.5;
    for (let x = 0; x < width; x++, y += slope) {
      const at = 2 * ((y | 0) * width + x);
      sums[at] += weight;
      sums[at + 1] += shaded;
    }
  }

  soft(y0, slope, shade, sign) {
    const { sums, width } = this;
    let y = y0;
    for (let x = 0; x < width; x++, y += slope) {
      const row = y | 0;
      const below = sign * Math.round(FULL * (y - row));
      const above = sign * FULL - below;
      const at = 2 * (row * width + x);
      sums[at] += above;
      sums[at + 1] += above * shade;
      sums[at + 2 * width] += below;
      sums[at + 2 * width + 1] += below * shade;
    }
  }

  // One pixel in each row from y0 to y1.
  steep(y0, across, y1, shade, weight) {
    const { sums, width } = this;
    const step = across > 0 ? 1 : -1;
    const shaded = weight * shade;
    const start = Math.round(y0);
    let x = 0;
    for (let row = start; row !== y1; row += step, x += across * step) {
      const at = 2 * (row * width + (x < width ? x | 0 : width - 1));
      sums[at] += weight;
      sums[at + 1] += shaded;
    }
  }

  // The picture: colours (red, green, blue of 256 shades) of the mean shades, more opaque where more lines
  // lie. tone: lines on a pixel that make it about two thirds opaque.
  paint(colours, tone) {
    const { sums, colours: out } = this;
    const alpha = opacities(tone);
    const most = alpha.length - 1;
    for (let i = 0; i < out.length; i++) {
      const weight = sums[2 * i];
      if (weight > 0) {
        const c = 3 * ((sums[2 * i + 1] / weight) | 0);
        out[i] =
          (alpha[weight < most ? weight : most] << 24) | (colours[c + 2] << 16) | (colours[c + 1] << 8) | colours[c];
      } else {
        out[i] = 0;
      }
    }
    return this.pixels;
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
