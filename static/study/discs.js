// Round marks in a picture of pixels, many at a time.

// A disc as pixels: across, along, share that is covered, one after another.
export function discOf(radius) {
  const cells = [];
  const reach = Math.ceil(radius + 1);
  for (let y = -reach; y <= reach; y++) {
    for (let x = -reach; x <= reach; x++) {
      const cover = Math.min(Math.max(radius + 0.5 - Math.hypot(x, y), 0), 1);
      if (cover > 0) {
        cells.push(x, y, cover);
      }
    }
  }
  return Float32Array.from(cells);
}

// The same without soft edges, for many marks: distances in an array of pixels `width` across.
export function dotOf(radius, width) {
  const cells = discOf(radius);
  const steps = [];
  for (let k = 0; k < cells.length; k += 3) {
    if (cells[k + 2] > 0.4) {
      steps.push(cells[k + 1] * width + cells[k]);
    }
  }
  return Int32Array.from(steps);
}

// Lays a disc over the pixels (RGBA) at x, y with the colour at colours[at] to colours[at + 2]. It must
// lie within the picture.
export function stamp({ width, data }, cells, x, y, colours, at, opacity) {
  const red = colours[at];
  const green = colours[at + 1];
  const blue = colours[at + 2];
  for (let k = 0; k < cells.length; k += 3) {
    const i = 4 * ((y + cells[k + 1]) * width + x + cells[k]);
    const share = cells[k + 2] * opacity;
    const under = (data[i + 3] / 255) * (1 - share);
    const whole = share + under;
    data[i] = (red * share + data[i] * under) / whole;
    data[i + 1] = (green * share + data[i + 1] * under) / whole;
    data[i + 2] = (blue * share + data[i + 2] * under) / whole;
    data[i + 3] = 255 * whole;
  }
}
