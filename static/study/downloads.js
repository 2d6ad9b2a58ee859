// Files of the study, pictures of what is on the page, and the lines for a shell that get the same.

import { jobUrl } from '../api.js';
import { find, make } from '../dom.js';
import { joined } from './canvas.js';
import { pageColour } from './paint.js';
import { id, studyUrl } from './source.js';

function save(url, name) {
  const link = make('a', { href: url, download: name });
  link.click();
}

function quoted(text) {
  return /[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

// The selected designs as a table for spreadsheets.
function selectedTable(designs, selection) {
  const head = [
    'member',
    'job',
    'name',
    'state',
    ...designs.columns.map(({ key, unit }) => (unit ? `${key} (${unit})` : key)),
  ];
  const lines = [...selection.rows()].map((row) => [
    designs.members[row],
    designs.jobs[row],
    designs.name(row),
    designs.state(row),
    ...designs.columns.map(({ data, words }) => (data[row] !== data[row] ? '' : words ? words[data[row]] : data[row])),
  ]);
  return [head, ...lines].map((line) => line.map((cell) => quoted(String(cell))).join(',')).join('\r\n');
}

const FILES = [
  ['All designs (CSV)', () => studyUrl('/export.csv')],
  ['For Optuna (CSV)', () => studyUrl('/export.csv', { format: 'optuna' })],
  ['All designs (JSON)', () => studyUrl('/designs', { format: 'columns' })],
  ['Result (JSON)', () => jobUrl(id, '/result')],
  ['Document (JSON)', () => jobUrl(id, '/document')],
];

// lines(): [what, curl line] as the page is now. charts: id of a section -> what makes its picture.
export function setUpDownloads(designs, selection, charts, lines) {
  const selected = make('button', { type: 'button' }, 'Selected designs (CSV)');
  selected.addEventListener('click', () => {
    if (!selection()) {
      return;
    }
    const url = URL.createObjectURL(new Blob([selectedTable(designs(), selection())], { type: 'text/csv' }));
    save(url, `study-${id}-selected.csv`);
    setTimeout(() => URL.revokeObjectURL(url), 1000);
  });
  find('files').replaceChildren(
    ...FILES.map(([name, url]) => make('li', {}, make('a', { href: url(), download: true }, name))),
    make('li', {}, selected),
  );
  for (const button of document.querySelectorAll('[data-picture]')) {
    button.addEventListener('click', () => picture(button.dataset.picture, charts));
  }
  const list = find('curl-lines');
  list.closest('details').addEventListener('toggle', () => {
    list.replaceChildren(...lines().flatMap(([what, line]) => [make('dt', {}, what), make('dd', {}, curlLine(line))]));
  });
}

function curlLine(line) {
  const text = make('code', {}, line);
  const copy = make('button', { type: 'button', class: 'small' }, 'Copy');
  copy.addEventListener('click', async () => {
    await navigator.clipboard.writeText(line);
    copy.textContent = 'Copied';
  });
  return make('div', { class: 'curl' }, text, navigator.clipboard ? copy : null);
}

function picture(name, charts) {
  const chart = charts.get(name);
  if (chart?.picture) {
    const url = chart.picture();
    if (url) {
      save(url, `study-${id}-${name}.png`);
    }
    return;
  }
  joined(find(`${name}-plot`), pageColour('card')).toBlob((blob) => {
    const url = URL.createObjectURL(blob);
    save(url, `study-${id}-${name}.png`);
    setTimeout(() => URL.revokeObjectURL(url), 1000);
  });
}
