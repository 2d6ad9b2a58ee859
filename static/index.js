// The page of all jobs. The filter and the compared jobs are part of the address.

import { request } from './api.js';
import { showComparison } from './compare.js';
import { find, setText } from './dom.js';
import { JobList } from './list.js';
import { poll } from './poll.js';
import { showProblem } from './problem.js';
import { showSession } from './session.js';
import { setUpSubmit } from './submit.js';

const address = new URLSearchParams(window.location.search);
const idsInAddress = (address.get('compare') || '').split(',').map(Number);
const selected = new Set(idsInAddress.filter((id) => Number.isSafeInteger(id) && id > 0));
const filter = find('filter-state');
const earlier = []; // cursors of the pages before this one
let cursor = null;
let next = null;

filter.value = address.get('state') || '';

function saveAddress() {
  const parts = [];
  if (filter.value) {
    parts.push(`state=${filter.value}`);
  }
  if (selected.size > 0) {
    parts.push(`compare=${[...selected].join(',')}`);
  }
  const query = parts.length > 0 ? `?${parts.join('&')}` : '';
  window.history.replaceState(null, '', window.location.pathname + query + window.location.hash);
}

function compare() {
  saveAddress();
  showComparison([...selected].sort((a, b) => a - b));
}

const list = new JobList(selected, compare);

function listUrl() {
  const query = new URLSearchParams();
  if (filter.value) {
    query.set('state', filter.value);
  }
  if (cursor !== null) {
    query.set('cursor', cursor);
  }
  const text = query.toString();
  return `/api/v1/jobs${text ? `?${text}` : ''}`;
}

async function update() {
  try {
    const page = await request(listUrl());
    const isLive = list.show(page.jobs);
    next = page.next ?? null;
    showProblem(find('list-problem'), null);
    find('empty').hidden = page.jobs.length > 0;
    setText(find('empty'), filter.value ? 'No job is in this state.' : 'There are no jobs yet.');
    find('pages').hidden = next === null && earlier.length === 0;
    find('older').disabled = next === null;
    find('newer').disabled = earlier.length === 0;
    setText(find('live'), isLive ? 'refreshing while jobs run' : '');
    return isLive;
  } catch (problem) {
    showProblem(find('list-problem'), problem);
    setText(find('live'), '');
    return problem.status === 0;
  }
}

const refresh = poll(update, '/api/v1/events', (report) => list.showProgress(report));

function goTo(target) {
  cursor = target;
  refresh();
}

filter.addEventListener('change', () => {
  earlier.length = 0;
  saveAddress();
  goTo(null);
});
find('older').addEventListener('click', () => {
  earlier.push(cursor);
  goTo(next);
});
find('newer').addEventListener('click', () => goTo(earlier.pop()));
find('compare-clear').addEventListener('click', () => {
  list.clearSelection();
  compare();
});
setUpSubmit(refresh);
showSession();
refresh();
showComparison([...selected].sort((a, b) => a - b));
