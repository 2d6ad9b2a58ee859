// Round marks in a picture of pixels, many at a time.

// A disc as pixels: [across, along, share that is covered] each.
export function discOf(radius) {
  const cells = [];
  const reach = Math.ceil(radius + 1);
  for (let y = -reach; y <= reach; y++) {
    for (let x = -reach; x <= reach; x++) {
      const cover = Math.min(Math.max(radius + 0.5 - Math.hypot(x, y), 0), 1);
      if (cover > 0) {
        cells.push([x, y, cover]);
      }
    }
  }
  return cells;
}

// Lays a disc over the pixels (RGBA) at x, y with a colour at colours[at], at + 1, at + 2.
export function stamp(pixels, cells, x, y, colours, at, opacity) {
  const { width, height, data } = pixels;
  for (const [across, along, cover] of cells) {
    const column = x + across;
    const row = y + along;
    if (column < 0 || row < 0 || column >= width || row >= height) {
      continue;
    }
    const i = 4 * (row * width + column);
    const share = cover * opacity;
    const under = data[i + 3] / 255 * (1 - share);
    const whole = share + under;
    for (let c = 0; c < 3; c++) {
      data[i + c] = (colours[at + c] * share + data[i + c] * under) / whole;
    }
    data[i + 3] = 255 * whole;
  }
}
