// Colours of the drawings: the map for values is that of the PNG plots.

const MAP = [
  [68, 1, 84],
  [70, 50, 126],
  [54, 92, 141],
  [39, 127, 142],
  [31, 161, 135],
  [74, 193, 109],
  [159, 218, 58],
  [253, 231, 37],
];

export const SERIES = ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#56b4e9', '#e69f00'];

const dark = window.matchMedia('(prefers-color-scheme: dark)');
const print = window.matchMedia('print'); // always on white

// On a light page its yellow end, and on a dark one its dark end, would not be seen as a line.
function ends() {
  return dark.matches && !print.matches ? [0.22, 1] : [0, 0.9];
}

// Red, green and blue at t in 0 .. 1.
export function shade(t) {
  const [low, high] = ends();
  const place = (low + Math.min(Math.max(t, 0), 1) * (high - low)) * (MAP.length - 1);
  const k = Math.min(Math.floor(place), MAP.length - 2);
  return MAP[k].map((part, c) => Math.round(part + (place - k) * (MAP[k + 1][c] - part)));
}

export function shadeText(t) {
  return `rgb(${shade(t).join(',')})`;
}

// The colour of a line that stands for itself.
export function lineColour() {
  return dark.matches && !print.matches ? SERIES[4] : SERIES[0];
}

// What follows from the colours of the page is worked out once for each of the two.
const kept = new Map();

// Calls back when the colours are others: for a dark page, or for paper.
export function onColours(listener) {
  for (const query of [dark, print]) {
    query.addEventListener('change', () => {
      kept.clear();
      listener();
    });
  }
}

function once(name, make) {
  if (!kept.has(name)) {
    kept.set(name, make());
  }
  return kept.get(name);
}

// 256 shades as red, green, blue one after another.
export function shades() {
  return once('shades', () => Uint8Array.from({ length: 3 * 256 }, (_, i) => shade(Math.floor(i / 3) / 255)[i % 3]));
}

// A colour of the style sheets by the name of its variable.
export function pageColour(name) {
  return once(name, () => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim());
}

// The same as red, green, blue; of colours written as #rrggbb.
export function pageParts(name) {
  const text = pageColour(name);
  return [1, 3, 5].map((at) => parseInt(text.slice(at, at + 2), 16));
}

// The colour of each row by a column: 0 .. 255, and 255 for rows without a value or no column at all.
export function rowShades(designs, column) {
  const all = new Uint8Array(designs.count).fill(128);
  if (column) {
    for (let row = 0; row < all.length; row++) {
      const place = column.place(column.data[row]);
      all[row] = place === place ? Math.round(255 * Math.min(Math.max(place, 0), 1)) : 0;
    }
  }
  return all;
}
