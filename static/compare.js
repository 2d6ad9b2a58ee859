// Several jobs side by side: one plot, one table.

import { request } from './api.js';
import { find, make } from './dom.js';
import { byImportance, isErrorOf, number, quantity } from './format.js';
import { showProblem } from './problem.js';

function headOf(jobs) {
  return make('thead', {}, make('tr', {}, make('th', { scope: 'col' }, 'Quantity'),
    make('th', { scope: 'col' }, 'Unit'),
    ...jobs.map((job) => make('th', { scope: 'col', class: 'number' },
      make('a', { href: `/jobs/${job.id}` }, `Job ${job.id}`),
      make('span', { class: 'job-name clamp', title: job.name }, job.name)))));
}

function groupOf(title, columns, rows) {
  const head = make('tr', {}, make('th', { scope: 'rowgroup', colspan: columns }, title));
  return rows.length > 0 ? [make('tbody', { class: 'group' }, head, ...rows)] : [];
}

// A parameter of the jobs, as it was written in each.
function parameterRow({ pointer, texts }) {
  return make('tr', { 'data-pointer': pointer },
    make('th', { scope: 'row' }, make('code', {}, pointer)), make('td'),
    ...texts.map((text) => make('td', { class: 'number' }, text === null ? 'default' : String(text))));
}

function metricRow({ name, values }) {
  const { label, unit } = quantity(name);
  return make('tr', { 'data-metric': name }, make('th', { scope: 'row' }, label),
    make('td', { class: 'unit' }, unit),
    ...values.map((value) => make('td', { class: 'number' }, number(value))));
}

function showTable({ jobs, parameters, metrics }) {
  const columns = jobs.length + 2;
  const names = metrics.map(({ name }) => name);
  const rows = metrics.filter(({ name }) => !isErrorOf(name, names)).sort((a, b) => byImportance(a.name, b.name));
  find('compare-table').replaceChildren(headOf(jobs),
    ...groupOf('Where the jobs differ', columns, parameters.map(parameterRow)),
    ...groupOf('Results', columns, rows.map(metricRow)));
}

function showPlot(query, ids) {
  const plot = `/api/v1/plots/overlay.png${query}`;
  const image = find('compare-plot');
  if (image.getAttribute('src') !== plot) {
    find('compare-figure').hidden = false;
    image.alt = `Curves against pressure of the jobs ${ids.join(', ')}`;
    image.src = plot;
    find('compare-link').href = plot;
  }
}

// Too many jobs, or one without a curve: the table is shown alone.
find('compare-plot').addEventListener('error', () => {
  find('compare-figure').hidden = true;
});

// Shows the comparison of the jobs with these ids; hides it when there are fewer than two.
export async function showComparison(ids) {
  const section = find('compare');
  section.hidden = ids.length < 2;
  if (section.hidden) {
    return;
  }
  const query = `?jobs=${ids.join(',')}`;
  showPlot(query, ids);
  try {
    showTable(await request(`/api/v1/compare${query}`));
    showProblem(find('compare-problem'), null);
  } catch (problem) {
    showProblem(find('compare-problem'), problem);
  }
}
