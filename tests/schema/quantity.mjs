// Quantities as docs/JOBS.md describes them, read without UDUNITS: a decimal number, a space or
// none, and a product of units of this table.

const metre = [1, 0, 0, 0, 0];
const kilogram = [0, 1, 0, 0, 0];
const second = [0, 0, 1, 0, 0];
const radian = [0, 0, 0, 1, 0];
const byte = [0, 0, 0, 0, 1];
const force = [1, 1, -2, 0, 0];
const pressure = [-1, 1, -2, 0, 0];
const one = [0, 0, 0, 0, 0];

// Whether prefixes may stand before it, value in SI, dimension.
const units = {
  m: [true, 1, metre], in: [false, 0.0254, metre], ft: [false, 0.3048, metre],
  g: [true, 1e-3, kilogram], s: [true, 1, second], min: [false, 60, second],
  h: [false, 3600, second], d: [false, 86400, second], Hz: [true, 1, [0, 0, -1, 0, 0]],
  rad: [true, 1, radian], deg: [false, Math.PI / 180, radian], degree: [false, Math.PI / 180, radian],
  degrees: [false, Math.PI / 180, radian], '°': [false, Math.PI / 180, radian],
  Pa: [true, 1, pressure], bar: [true, 1e5, pressure],
  psi: [false, 4.4482216152605 / 0.0254 ** 2, pressure], N: [true, 1, force],
  l: [true, 1e-3, [3, 0, 0, 0, 0]], '%': [false, 0.01, one],
};
const prefixes = { n: 1e-9, u: 1e-6, 'µ': 1e-6, m: 1e-3, c: 1e-2, d: 0.1, h: 100, k: 1e3, M: 1e6,
  G: 1e9, T: 1e12 };
const amounts = { kB: 1e3, MB: 1e6, GB: 1e9, TB: 1e12, KiB: 2 ** 10, MiB: 2 ** 20, GiB: 2 ** 30,
  TiB: 2 ** 40 };

function unitOf(name) {
  if (Object.hasOwn(amounts, name)) {
    return [amounts[name], byte];
  }
  if (Object.hasOwn(units, name)) {
    return units[name].slice(1);
  }
  const inner = name.slice(1);
  return Object.hasOwn(prefixes, name[0]) && Object.hasOwn(units, inner) && units[inner][0]
    ? [prefixes[name[0]] * units[inner][1], units[inner][2]] : null;
}

// [scale, dimension], or null for what is no unit.
function readUnit(text) {
  let scale = 1;
  const dimension = [...one];
  let sign = 1;
  let rest = text;
  if (rest.startsWith('1/')) {
    sign = -1;
    rest = rest.slice(2);
  }
  for (;;) {
    const factor = /^([A-Za-zµ]+|°|%)(?:\^?(-?[1-9])|(⁻?[¹²³]))?/.exec(rest);
    const unit = factor ? unitOf(factor[1]) : null;
    if (!unit) {
      return null;
    }
    const raised = factor[3]?.replace(/./g, (digit) => '-123'['⁻¹²³'.indexOf(digit)]);
    const power = sign * Number(factor[2] ?? raised ?? 1);
    scale *= unit[0] ** power;
    unit[1].forEach((exponent, i) => { dimension[i] += exponent * power; });
    rest = rest.slice(factor[0].length);
    if (rest === '') {
      return [scale, dimension];
    }
    const operator = /^( *[/*.] *| +)/.exec(rest);
    if (!operator) {
      return null;
    }
    sign = operator[0].includes('/') ? -1 : 1;
    rest = rest.slice(operator[0].length);
  }
}

// The value in SI of `text`, which must have the dimension of `unit`; null when it has not.
export function readQuantity(text, unit) {
  const number = /^[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?/.exec(text);
  if (!number || Buffer.byteLength(text) > 64) {
    return null;
  }
  const given = readUnit(text.slice(number[0].length).replace(/^ */, ''));
  const wanted = readUnit(unit);
  if (!given || String(given[1]) !== String(wanted[1])) {
    return null;
  }
  const value = Number(number[0]) * given[0];
  const vanished = value === 0 && /[1-9]/.test(number[0].split(/[eE]/)[0]);
  return Number.isFinite(value) && !vanished ? value : null;
}
