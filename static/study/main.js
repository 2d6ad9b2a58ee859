// The page of a study. What is seen — metric, axes, ranges, sort, slices — is in the address.

import { isActive, jobUrl, request } from '../api.js';
import { find, make, setText } from '../dom.js';
import { byImportance, number } from '../format.js';
import { showProblem } from '../problem.js';
import { Address } from './address.js';
import { Designs } from './designs.js';
import { setUpDownloads } from './downloads.js';
import { Explorer } from './explorer.js';
import { setUpImportance } from './importance.js';
import { History } from './history.js';
import { Pareto } from './pareto.js';
import { setUpQuality } from './quality.js';
import { Ranking } from './ranking.js';
import { Search, designText, solve } from './search.js';
import { Slice } from './slice.js';
import { about, columns, studyUrl, summary } from './source.js';
import { Status } from './status.js';
import { onColours } from './paint.js';

const TRUSTED = 0.5; // R² of a surrogate whose shares of the variance are worth a headline

const address = new Address();
const history = new History();
const charts = new Map();
let designs = null;
let explorer = null;
let panels = []; // that ask the daemon
let parts = []; // that know the designs
let metric = '';
let study = null;
let wanted = {}; // objective and ranking, as the study's document has them, and the history of its result

// Metrics that say how well a solve went are of less interest than what it found.
function metricsByInterest() {
  return designs.metrics
    .filter(({ varies, key }) => varies && !key.endsWith('_error'))
    .sort((a, b) => byImportance(a.key, b.key));
}

function showTiles() {
  const column = designs.byKey.get(metric);
  if (!column) {
    return;
  }
  let least = -1;
  let most = -1;
  for (let row = 0; row < designs.count; row++) {
    const value = column.data[row];
    if (value === value) {
      least = least < 0 || value < column.data[least] ? row : least;
      most = most < 0 || value > column.data[most] ? row : most;
    }
  }
  for (const [name, row] of [
    ['least', least],
    ['most', most],
  ]) {
    setText(find(`${name}-value`), row < 0 ? '–' : column.textWithUnit(column.data[row]));
    find(`${name}-design`).replaceChildren(
      row < 0 ? '\u00a0' : make('a', { href: `/jobs/${designs.jobs[row]}`, title: designs.name(row) }, designs.label(row)),
    );
  }
}

function chooseMetric(key) {
  metric = key;
  address.set('metric', key);
  setText(find('decides'), '…');
  setText(find('trust'), '…');
  showTiles();
  explorer.recolour(designs.byKey.get(key));
  panels.forEach((panel) => panel.renew());
  showHistory();
}

function setUpMetric() {
  const metrics = metricsByInterest();
  const given = address.get('metric');
  metric = designs.byKey.has(given) ? given : (metrics[0]?.key ?? designs.metrics[0]?.key ?? '');
  find('metric').replaceChildren(
    ...(metrics.length > 0 ? metrics : designs.metrics).map(({ key, label }) => make('option', { value: key }, label)),
  );
  find('metric').value = metric;
  find('metric').onchange = () => chooseMetric(find('metric').value);
}

function showHistory() {
  const column = designs.byKey.get(metric);
  const isOptimisation = study.sampling === 'optimise';
  find('history').hidden = !isOptimisation || !column;
  if (isOptimisation && column) {
    history.show(designs, column, wanted);
  }
}

// Two objectives that may be at odds: the metric most, and mass, stress or stretch least.
function usualObjectives() {
  const metrics = metricsByInterest();
  if (metric === '') {
    return [];
  }
  const cost =
    metrics.find(({ key }) => key !== metric && key.startsWith('mass')) ??
    metrics.find(({ key }) => key !== metric && /^(max_|cavity_volume)/.test(key)) ??
    metrics.find(({ key }) => key !== metric);
  return [['max', metric], ...(cost ? [['min', cost.key]] : [])];
}

// Without designs there is nothing to explore.
function showParts() {
  for (const part of document.querySelectorAll(
    '#study > .tiles, #study > .card:not(#history, #failures, #downloads), #study > .pair',
  )) {
    part.hidden = designs.count === 0;
  }
}

// What of the page needs the designs: made anew when their columns change.
function setUp() {
  showParts();
  if (designs.count === 0) {
    return;
  }
  about(designs);
  setUpMetric();
  explorer = new Explorer(designs, address, designs.byKey.get(metric));
  const key = () => metric;
  const usual = usualObjectives();
  const [importance, effects] = setUpImportance(key, (text, r2) => {
    setText(find('decides'), r2 < TRUSTED ? 'not clear yet' : text);
    setText(find('trust'), `R² ${r2.toFixed(3)}`);
  });
  const quality = setUpQuality(key);
  const slice = new Slice(designs, address, key, showChosen);
  const pareto = new Pareto(designs, address, usual, {
    onFront: (rows, keys) => explorer.showFront(rows, keys),
    onPick: (row, on) => explorer.pick(row, on),
    onHover: (row) => explorer.point(row),
  });
  const ranking = new Ranking(
    designs,
    address,
    usual.map(([way, name]) => [way, name, 1]),
    Boolean(wanted.ranking),
  );
  const search = new Search(designs, address, { metric, goal: usual[1]?.[1] ?? metric });
  panels.forEach((panel) => panel.retire());
  parts = [slice, pareto, ranking, search];
  panels = [importance, effects, quality, slice.panel, pareto.panel, ranking];
  for (const [name, chart] of [
    ['slice', slice.chart],
    ['history', history.chart],
  ]) {
    charts.set(name, chart);
  }
  showTiles();
  showHistory();
}

// A place of the slice that somebody clicked, to be solved.
function showChosen(values, expected, { title, unit }) {
  const button = make('button', { type: 'button', class: 'small', 'data-confirm': true }, 'Solve it');
  button.addEventListener('click', () => solve(values, button, find('search-problem')));
  find('slice-chosen').replaceChildren(
    make('span', { class: 'state predicted' }, 'predicted'),
    ` ${title} ${number(expected)} ${unit} at ${designText(designs, values)} `,
    button,
  );
}

function curlLines() {
  const { origin } = window.location;
  const line = (url) => `curl -sS '${origin}${url}'`;
  const objectives =
    address.get('pareto') ||
    usualObjectives()
      .map(([way, key]) => `${way}:${key}`)
      .join(',');
  return [
    ['All designs, for spreadsheets', line(studyUrl('/export.csv'))],
    ['All designs, by columns', line(studyUrl('/designs', { format: 'columns' }))],
    ['Designs that no other one beats', line(studyUrl('/pareto', { objectives }))],
    [`What decides ${designs.byKey.get(metric)?.title}`, line(studyUrl('/importance', { metric }))],
    [
      'The document, and the same study again',
      `curl -sS '${origin}/api/v1/jobs/${study.id}/document' | curl -sS -H 'Content-Type: application/json' --data-binary @- '${origin}/api/v1/jobs'`,
    ],
  ];
}

// Takes in designs that are new; columns that are new, or that begin to vary, make the page anew.
async function takeDesigns(isOver) {
  const next = new Designs(await columns());
  const kind = ({ columns: all }) => all.map(({ key, varies }) => `${key} ${varies}`).join();
  const isSame = explorer && kind(next) === kind(designs);
  designs = next;
  if (isSame) {
    about(designs);
    explorer.take(designs);
    parts.forEach((part) => {
      part.designs = designs;
    });
    showTiles();
    showHistory();
    if (isOver) {
      panels.forEach((panel) => panel.renew());
    }
  } else {
    explorer?.retire();
    setUp();
  }
  if (isOver && wanted.objective) {
    readHistory().catch(() => {}); // the course of the metric is shown meanwhile
  }
}

// Filters by a reason of failure, as if it had been typed.
function showReason(code) {
  const input = find('filter');
  input.value = `reason = ${/^\w+$/.test(code) ? code : `"${code}"`}`;
  input.dispatchEvent(new Event('input'));
  input.scrollIntoView({ block: 'nearest' });
  input.focus({ preventScroll: true });
}

// How an optimisation that has ended went.
async function readHistory() {
  const { history: list } = await request(jobUrl(study.id, '/result'));
  wanted = { ...wanted, history: list };
  showHistory();
}

// What the study is after. Its document may be long, so nothing waits for it.
async function readDocument() {
  const { objective, ranking } = await request(jobUrl(study.id, '/document'));
  wanted = { objective, ranking };
  showHistory();
  if (objective && !isActive(study.state)) {
    await readHistory();
  }
  if (ranking) {
    panels.at(-1)?.offerPreset();
  }
}

async function start() {
  performance.mark('study-start');
  try {
    const [first, document] = await Promise.all([summary(), columns()]);
    study = first;
    performance.mark('study-data');
    designs = new Designs(document);
  } catch (problem) {
    showProblem(find('problem'), problem);
    return;
  }
  if (study.sampling === 'optimise') {
    find('parallel-title').closest('section').before(find('history')); // what such a study is about comes first
  }
  find('study').hidden = false;
  const status = new Status(takeDesigns, showReason);
  status.start(study);
  setUp();
  setUpDownloads(
    () => designs,
    () => explorer?.selection,
    charts,
    curlLines,
  );
  onColours(() => explorer?.repaint());
  requestAnimationFrame(() =>
    setTimeout(() => {
      performance.mark('study-usable');
      readDocument().catch(() => {}); // without it the page is only less well informed
    }),
  );
}

start();
