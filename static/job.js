// The page of one job.

import { isActive, jobUrl, post, request } from './api.js';
import { describe, find, make, setText } from './dom.js';
import {
  byImportance, instant, isErrorOf, moment, number, quantity, stateWord, withUnit,
} from './format.js';
import { poll } from './poll.js';
import { showProblem } from './problem.js';
import { showSession } from './session.js';

const CAPTIONS = {
  angle: 'Bending angle against pressure',
  midline: 'Centreline at the recorded pressures',
  tip: 'Path of the tip',
  midline3d: 'Centreline in three views',
  tip3d: 'Path of the tip in three views',
  measured: 'Simulation against measurement',
  surface: 'Deformed body, coloured by the largest stretch',
  convergence: 'Error against element size',
  curve: 'Computed values on the curve of the reference',
  curves: 'Every member against pressure',
  metric: 'A metric of the members',
  ranking: 'The best designs',
  workspace: 'Positions of the tip in three views',
  twist: 'Twist angle of every member against pressure',
  contraction: 'Contraction of every member against pressure',
  mesh: 'Convergence with the mesh',
  fit: 'Stress against strain, measured and fitted',
  stress: 'Stress of the material against stretch',
  time: 'Elongation, speed and pressure over time',
  phase: 'Speed against elongation',
  steady: 'Elongation at the end of each held set-point',
  control: 'Elongation under position control',
  coefficients: 'Identified coefficients with their polynomials',
  fitted: 'Trials, measured and simulated',
  snap: 'The fastest snap',
  motion: 'Elongation of plate and cells, speed and pressure over time',
  'snap-path': 'Equilibrium under pressure and under axial force',
  shapes: 'Meridian in its states',
  held: 'Force at the natural length against pressure',
  stability: 'Loss of axisymmetry by harmonic',
  suction: 'Suction and bending against the number of suckers',
};

const ACTIONS = [
  ['cancel', 'Cancel', (state) => isActive(state) || state === 'held'],
  ['hold', 'Hold', (state) => state === 'queued'],
  ['release', 'Release', (state) => state === 'held'],
  ['retry', 'Retry', (state) => ['failed', 'timed_out', 'cancelled'].includes(state)],
];

// Fields of one recorded pressure: many, so they are folded away.
const STATE_FILE = /-\d{4}\.vtu$/;

const id = window.location.pathname.split('/').filter(Boolean).pop();
let shownActions = '';
let hasResult = false;

function duration(job) {
  const from = instant(job.started);
  const to = instant(job.finished) || (isActive(job.state) ? new Date() : null);
  return from && to ? `${((to - from) / 1000).toFixed(1)}\u00a0s` : '–';
}

function showFacts(job) {
  const labels = Object.entries(job.labels || {}).map(([name, value]) => `${name}: ${value}`);
  const facts = [['Created', moment(job.created)], ['Started', moment(job.started)],
    ['Finished', moment(job.finished)], ['Duration', duration(job)]];
  if (labels.length > 0) {
    facts.push(['Labels', labels.join(' · ')]);
  }
  describe(find('facts'), facts);
}

async function act(name) {
  try {
    const answer = await post(jobUrl(id, `/${name}`));
    showProblem(find('action-problem'), null);
    if (name === 'retry' && answer.id && String(answer.id) !== id) {
      window.location.assign(`/jobs/${answer.id}`);
      return;
    }
  } catch (problem) {
    showProblem(find('action-problem'), problem);
  }
  refresh();
}

function showActions(state) {
  const wanted = ACTIONS.filter(([, , applies]) => applies(state) && state !== 'cancelling');
  const names = wanted.map(([name]) => name).join();
  if (names !== shownActions) {
    shownActions = names;
    find('actions').replaceChildren(...wanted.map(([name, label]) => {
      const button = make('button', { type: 'button', 'data-action': name }, label);
      button.addEventListener('click', () => {
        button.disabled = true;
        act(name);
      });
      return button;
    }));
  }
}

// Seconds as people say them.
function timeLeft(seconds) {
  if (typeof seconds !== 'number') {
    return '';
  }
  if (seconds < 90) {
    return `about ${Math.max(1, Math.round(seconds))}\u00a0s left`;
  }
  return seconds < 5400
    ? `about ${Math.round(seconds / 60)}\u00a0min left`
    : `about ${Math.round(seconds / 3600)}\u00a0h left`;
}

// What a running job has reported: the fraction, and the parts that its kind has.
function showProgress(report) {
  const share = Math.min(Math.max(Number(report.fraction) || 0, 0), 1);
  const parts = [`${Math.round(100 * share)}\u00a0%`];
  if (report.step) {
    parts.push(report.steps ? `step ${report.step} of ${report.steps}` : `step ${report.step}`);
  }
  if (typeof report.pressure_kPa === 'number') {
    parts.push(`${number(report.pressure_kPa)}\u00a0kPa`);
  }
  if (report.eta_s !== null && share < 1) {
    parts.push(timeLeft(report.eta_s));
  }
  find('progress').value = share;
  setText(find('percent'), parts.filter(Boolean).join(' · '));
}

function showState(job) {
  document.title = `${job.name || `Job ${job.id}`} · PneuLab`;
  setText(find('kind'), `Job ${job.id} · ${job.kind}`);
  setText(find('name'), job.name || `Job ${job.id}`);
  find('state').className = `state ${job.state}`;
  setText(find('state'), stateWord(job.state));
  const isRunning = job.state === 'running' || job.state === 'starting';
  find('progress').hidden = !isRunning;
  if (isRunning) {
    showProgress(job.progress_detail || { fraction: job.progress });
  } else {
    setText(find('percent'), '');
  }
  const code = job.reason_code && job.reason_code !== 'ok' && job.reason_code !== job.state
    ? stateWord(job.reason_code) : '';
  const reason = [code, job.message].filter(Boolean).join(': ');
  find('reason').hidden = reason === '' || job.state === 'succeeded';
  setText(find('reason'), reason);
}

// Two digits are enough for an estimate.
function errorText(error) {
  return typeof error === 'number' ? `±\u00a0${number(Number(error.toPrecision(2)))}` : '';
}

function showMetrics(metrics) {
  const keys = Object.keys(metrics || {});
  const entries = Object.entries(metrics || {}).filter(([key]) => !isErrorOf(key, keys))
    .sort(([a], [b]) => byImportance(a, b));
  find('metrics').hidden = entries.length === 0;
  find('metric-table').replaceChildren(
    make('thead', {}, make('tr', {}, make('th', { scope: 'col' }, 'Metric'),
      make('th', { scope: 'col', class: 'number' }, 'Value'),
      make('th', { scope: 'col', class: 'uncertainty' }, 'Error'),
      make('th', { scope: 'col' }, 'Unit'))),
    make('tbody', {}, ...entries.map(([key, value]) => {
      const { label, unit } = quantity(key);
      return make('tr', { 'data-metric': key }, make('th', { scope: 'row' }, label),
        make('td', { class: 'number' }, number(value)),
        make('td', { class: 'uncertainty' }, errorText(metrics[`${key}_error`])),
        make('td', { class: 'unit' }, unit));
    })));
}

// Links to plots and files are addresses, or bare names under `folder`.
function address(link, folder, ending = '') {
  return link.startsWith('/') ? link : jobUrl(id, `/${folder}/${encodeURIComponent(link)}${ending}`);
}

function fileName(link) {
  return decodeURIComponent(link.split('?')[0].split('/').pop());
}

function showPlots(links) {
  find('plots').hidden = links.length === 0;
  find('plot-list').replaceChildren(...links.map((link) => {
    const url = address(link, 'plots', '.png');
    const name = fileName(url).replace(/\.png$/, '');
    const caption = CAPTIONS[name] || name;
    const image = make('img', { src: url, alt: caption, width: 800, height: 600 });
    const figure = make('figure', { class: 'plot', 'data-plot': name },
      make('a', { href: url, title: 'Open in full size' }, image));
    // a plot that cannot be drawn, for want of a file, leaves no broken picture
    image.addEventListener('error', () => figure.remove());
    return figure;
  }));
}

function showFiles(job) {
  const links = job.links || {};
  const files = links.document ? [['Job document', links.document]] : [];
  if (hasResult) {
    files.push(['Result (JSON)', links.result || jobUrl(id, '/result')],
      ['Samples (CSV)', links.samples || jobUrl(id, '/samples.csv')]);
  }
  if (job.started) {
    files.push(['Log', links.log || jobUrl(id, '/log')]);
  }
  const states = [];
  for (const link of links.artifacts || []) {
    const url = address(link, 'artifacts');
    (STATE_FILE.test(url) ? states : files).push([fileName(url), url]);
  }
  const item = ([name, url]) => make('li', {}, make('a', { href: url }, name));
  const list = find('file-list');
  const isOpen = list.querySelector('details')?.open || false;
  list.replaceChildren(...files.map(item));
  if (states.length > 0) {
    const details = make('details', {}, make('summary', {}, `${states.length} VTU files`),
      make('ul', { class: 'plain' }, ...states.map(item)));
    details.open = isOpen;
    list.append(make('li', {}, details));
  }
}

function showResult(result) {
  const warnings = result.warnings || [];
  find('warnings').hidden = warnings.length === 0;
  find('warning-list').replaceChildren(...warnings.map((text) => make('li', {}, String(text))));
  const statistics = Object.entries(result.statistics || {});
  find('statistics').hidden = statistics.length === 0;
  describe(find('statistic-list'), statistics.map(([key, value]) =>
    [quantity(key).label, withUnit(key, value)]));
}

// What only a finished job has is loaded once.
async function showOutcome(job) {
  const hasMetrics = Object.keys(job.metrics || {}).length > 0;
  if (isActive(job.state) || hasResult) {
    return;
  }
  if (job.links?.result || hasMetrics) {
    try {
      showResult(await request(job.links?.result || jobUrl(id, '/result')));
      hasResult = true;
    } catch (problem) {
      if (problem.status !== 404) {
        showProblem(find('action-problem'), problem);
      }
    }
  }
  showMetrics(job.metrics);
  showPlots(hasResult ? job.links?.plots || [] : []);
}

async function update() {
  try {
    const job = await request(jobUrl(id));
    showProblem(find('problem'), null);
    find('job').hidden = false;
    showState(job);
    showFacts(job);
    showActions(job.state);
    await showOutcome(job);
    showFiles(job);
    return isActive(job.state);
  } catch (problem) {
    showProblem(find('problem'), problem);
    return problem.status === 0;
  }
}

const refresh = poll(update, `/api/v1/events?job=${encodeURIComponent(id)}`, showProgress);
showSession();
refresh();
