// The colours of the plots, and those of the page.

const AREA = [[68, 1, 84], [70, 50, 126], [54, 92, 141], [39, 127, 142], [31, 161, 135], [74, 193, 109],
  [159, 218, 58], [253, 231, 37]];

const SERIES = ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#56b4e9', '#e69f00', '#000000'];
const SERIES_ON_DARK = ['#4698e2', '#f07a36', '#22be92', '#de96be', '#98d6fa', '#f0b83e', '#eef1f5'];

export const dark = window.matchMedia('(prefers-color-scheme: dark)');

// The colour of the index-th curve, as the page is now. They start again after seven.
export function seriesColour(index) {
  const colours = dark.matches ? SERIES_ON_DARK : SERIES;
  return colours[index % colours.length];
}

// A colour of style.css by the name of its variable, as it is now.
export function pageColour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

function linear(part) {
  const c = part / 255;
  return c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4;
}

// A body where nothing touches it, and what a gripper holds, as the page is now.
export function graspColours() {
  const [bare, object] = dark.matches ? [[138, 148, 160], [203, 156, 104]] : [[206, 211, 217], [219, 172, 116]];
  return { bare: bare.map(linear), object: object.map(linear) };
}

// The map for areas as 256 colours of linear components, one after another.
export function areaShades() {
  const shades = new Float32Array(3 * 256);
  for (let i = 0; i < 256; i++) {
    const t = i / 255 * (AREA.length - 1);
    const k = Math.min(Math.floor(t), AREA.length - 2);
    for (let c = 0; c < 3; c++) {
      shades[3 * i + c] = linear(AREA[k][c] + (t - k) * (AREA[k + 1][c] - AREA[k][c]));
    }
  }
  return shades;
}
