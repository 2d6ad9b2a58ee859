// The table of jobs. Rows are kept and updated in place, so that focus and ticks survive a refresh.

import { isActive } from './api.js';
import { find, make, setText } from './dom.js';
import { ago, instant, moment, number, stateWord } from './format.js';

function labelText(labels) {
  return Object.entries(labels || {}).map(([name, value]) => `${name}: ${value}`).join(' · ');
}

// One row and what in it changes.
function makeRow(job, isSelected, onSelect) {
  const box = make('input', { type: 'checkbox', 'aria-label': `Compare job ${job.id}` });
  box.checked = isSelected;
  box.addEventListener('change', () => onSelect(job.id, box.checked));
  const name = job.name || `job ${job.id}`;
  const link = make('a', { href: `/jobs/${job.id}`, class: 'clamp', title: name }, name);
  const labels = labelText(job.labels);
  const state = make('span');
  const why = make('span', { class: 'why' });
  const progress = make('progress', { max: 1, 'aria-label': `Progress of job ${job.id}` });
  const angle = make('td', { class: 'number wide' });
  const narrowAngle = make('span', { class: 'narrow' });
  const created = make('time', {
    datetime: instant(job.created)?.toISOString(), title: moment(job.created),
  });
  const element = make('tr', { 'data-id': job.id },
    make('td', {}, box),
    make('td', { class: 'number' }, String(job.id)),
    make('td', { class: 'name' }, link, labels ? make('span', { class: 'labels' }, labels) : null),
    make('td', { class: 'wide' }, job.kind || '–'),
    make('td', {}, state, why, narrowAngle, progress),
    angle,
    make('td', { class: 'wide' }, created));
  return { element, box, state, why, progress, angle, narrowAngle, created };
}

function updateRow(row, job) {
  row.state.className = `state ${job.state}`;
  setText(row.state, stateWord(job.state));
  const reason = job.reason_code && job.reason_code !== 'ok' ? stateWord(job.reason_code) : '';
  setText(row.why, reason === stateWord(job.state) ? '' : reason);
  row.progress.hidden = job.state !== 'running' && job.state !== 'starting';
  row.progress.value = Math.min(Math.max(Number(job.progress) || 0, 0), 1);
  const angle = job.metrics?.bending_angle_deg;
  const text = typeof angle === 'number' ? `${number(angle)}°` : '';
  setText(row.angle, text || '–');
  setText(row.narrowAngle, text);
  row.box.disabled = text === '' && !row.box.checked;
  setText(row.created, ago(job.created));
}

export class JobList {
  // selected: a Set of ids, kept up to date; onChange is called when a person ticks a box.
  constructor(selected, onChange) {
    this.rows = new Map();
    this.states = new Map();
    this.select = (id, on) => {
      if (on) {
        selected.add(id);
      } else {
        selected.delete(id);
      }
      onChange();
    };
    this.selected = selected;
  }

  // Shows these jobs; returns whether any of them will change by itself.
  show(jobs) {
    const body = find('jobs');
    const rows = new Map();
    for (const job of jobs) {
      const row = this.rows.get(job.id)
        || makeRow(job, this.selected.has(job.id), this.select);
      updateRow(row, job);
      rows.set(job.id, row);
    }
    const elements = [...rows.values()].map((row) => row.element);
    const isSame = elements.length === body.children.length
      && elements.every((element, i) => body.children[i] === element);
    if (!isSame) {
      body.replaceChildren(...elements);
    }
    this.rows = rows;
    this.announce(jobs);
    return jobs.some((job) => isActive(job.state));
  }

  // A report of a running job, between two refreshes.
  showProgress({ job, fraction }) {
    const row = this.rows.get(job);
    if (row) {
      row.progress.value = fraction;
    }
  }

  // Says aloud what ended since the last refresh.
  announce(jobs) {
    const ended = jobs.filter((job) => !isActive(job.state) && this.states.has(job.id)
      && this.states.get(job.id) !== job.state);
    if (ended.length > 0) {
      setText(find('announce'), ended.map((job) => `Job ${job.id} ${stateWord(job.state)}.`).join(' '));
    }
    this.states = new Map(jobs.map((job) => [job.id, job.state]));
  }

  clearSelection() {
    this.selected.clear();
    for (const row of this.rows.values()) {
      row.box.checked = false;
    }
  }
}
