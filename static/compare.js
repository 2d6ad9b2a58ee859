// The page that compares jobs, as the daemon made it: the curves answer, and the bodies are turned
// together. What is drawn over the pressure, of grasps over the displacement, is part of the address.

import { jobUrl, request } from './api.js';
import { find, make } from './dom.js';
import { quantity } from './format.js';
import { remember } from './live.js';

const PRESSURE = 'pressure_kPa';
const WAY = 'displacement_mm';
const FIRST = ['grasp_force_N', 'bending_angle_deg', 'turn_angle_deg', 'elongation_mm'];

function label(key) {
  const { label: text, unit } = quantity(key);
  return unit ? `${text} (${unit})` : text;
}

function jobs() {
  return [...document.querySelectorAll('#compare-table th[data-job]')].map((head) => ({
    id: head.dataset.job, name: head.querySelector('.job-name').textContent || `Job ${head.dataset.job}`,
  }));
}

async function samplesOf({ id, name }) {
  try {
    const { kind, samples } = await request(jobUrl(id, '/result'));
    return { id, name, kind, samples: samples || [] };
  } catch {
    return { id, name, samples: [] }; // a job without a result has no curve
  }
}

// Of grasps the pull is what is compared, where any came so far: its samples, and the key of what they are drawn over.
function pulls(all) {
  const stages = all.map(({ samples, ...job }) => ({ ...job, samples: samples.filter(({ stage }) => stage === 'pull') }));
  const grasps = all.every(({ kind, samples }) => kind === 'grasp' || samples.length === 0);
  return grasps && stages.some(({ samples }) => samples.length > 0) ? [stages, WAY] : [all, PRESSURE];
}

// What all samples know as numbers, the most telling first.
function keysOf(all, x) {
  const keys = new Set(all.flatMap(({ samples }) => Object.entries(samples.at(-1) || {})
    .filter(([key, value]) => typeof value === 'number' && key !== x).map(([key]) => key)));
  const rank = (key) => (FIRST.includes(key) ? FIRST.indexOf(key) : FIRST.length);
  return [...keys].sort((a, b) => rank(a) - rank(b) || label(a).localeCompare(label(b)));
}

function seriesOf(all, x, key) {
  return all.map(({ id, name, samples }) => ({
    name: `${id} · ${name}`,
    points: samples.filter((sample) => typeof sample[key] === 'number' && typeof sample[x] === 'number')
      .map((sample) => [sample[x], sample[key]]),
  }));
}

async function setUpCurves() {
  const [all, x] = pulls(await Promise.all(jobs().map(samplesOf)));
  const keys = keysOf(all, x);
  if (keys.length === 0) {
    return; // the picture stays
  }
  const { Curves } = await import('./curves.js');
  const address = new URL(window.location.href);
  const select = make('select', { id: 'curve-key', autocomplete: 'off' },
    ...keys.map((key) => make('option', { value: key }, label(key))));
  select.value = keys.includes(address.searchParams.get('y')) ? address.searchParams.get('y') : keys[0];
  find('curves-bar').append(make('label', { class: 'inline' }, 'Show ', select));
  const place = make('div', { id: 'curve-chart', role: 'img' });
  find('curves').querySelector('figure').replaceChildren(place);
  const curves = new Curves(place);
  const show = () => {
    curves.show({ x: label(x), y: label(select.value), series: seriesOf(all, x, select.value) });
    place.setAttribute('aria-label', `${label(select.value)} against ${quantity(x).label.toLowerCase()} of ${all.length} jobs; `
      + 'the last values are in the table below');
  };
  select.addEventListener('change', () => {
    address.searchParams.set('y', select.value);
    window.history.replaceState(null, '', `${address.pathname}?${decodeURIComponent(address.searchParams)}`);
    show();
  });
  show();
}

async function setUpShapes() {
  if (find('shapes')) {
    const { linkBodies } = await import('./bodies.js');
    await linkBodies(find('shapes'));
  }
}

remember();
if (find('curves')) {
  setUpCurves();
  setUpShapes();
}
