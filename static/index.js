// The page of all jobs, as the daemon made it: it is kept up to date, and jobs for a comparison are kept
// from page to page. Filter, page and selection are part of the address.

import { find, setText } from './dom.js';
import { remember, renew } from './live.js';
import { poll } from './poll.js';
import { showProblem } from './problem.js';

const MOST = 12; // that can be compared
const ACTIVE = '.state.queued, .state.starting, .state.running, .state.cancelling, .state.retry_wait';

const address = new URLSearchParams(window.location.search);
const selected = new Set((address.get('compare') || '').split(',').filter((id) => /^[1-9]\d*$/.test(id)));
const button = find('compare-button');
const filter = find('filter');

function withSelection(url) {
  const target = new URL(url, window.location.href);
  target.searchParams.delete('compare');
  const rest = target.search + (selected.size > 0
    ? `${target.search ? '&' : '?'}compare=${[...selected].join(',')}` : '');
  return target.pathname + rest + target.hash;
}

function boxes() {
  return [...document.querySelectorAll('#jobs input[type="checkbox"]')];
}

// Everything that follows from what is selected.
function showSelection() {
  for (const box of boxes()) {
    box.checked = selected.has(box.value);
  }
  for (const link of document.querySelectorAll('#pages a')) {
    link.setAttribute('href', withSelection(link.getAttribute('href')));
  }
  button.disabled = selected.size < 2 || selected.size > MOST;
  find('compare-clear').hidden = selected.size === 0;
  const count = selected.size === 0 ? 'Tick jobs to compare them.'
    : `${selected.size} ${selected.size === 1 ? 'job' : 'jobs'} selected${selected.size > MOST ? `; up to ${MOST} can be compared` : ''}`;
  setText(find('compare-count'), count);
  window.history.replaceState(null, '', withSelection(window.location.href));
}

// Says aloud what ended since the last time.
function announce(before) {
  const ended = [...document.querySelectorAll('#jobs tr')].filter((row) => before.has(row.dataset.id)
    && !row.querySelector(ACTIVE));
  if (ended.length > 0) {
    setText(find('announce'), ended.map((row) =>
      `Job ${row.dataset.id} ${row.querySelector('.state').textContent}.`).join(' '));
  }
}

function activeJobs() {
  return new Set([...document.querySelectorAll('#jobs tr')].filter((row) => row.querySelector(ACTIVE))
    .map((row) => row.dataset.id));
}

async function update() {
  const before = activeJobs();
  try {
    await renew();
    showProblem(find('list-problem'), null);
  } catch (problem) {
    showProblem(find('list-problem'), problem);
    return true;
  }
  showSelection();
  announce(before);
  return activeJobs().size > 0;
}

function showProgress({ job, fraction }) {
  const bar = document.querySelector(`#jobs tr[data-id="${job}"] progress`);
  if (bar) {
    bar.value = fraction;
  }
}

remember();
showSelection();
filter.addEventListener('change', () => {
  const query = new URLSearchParams({ state: find('filter-state').value });
  window.location.assign(withSelection(`/${query.get('state') ? `?${query}` : ''}`));
});
find('picked').addEventListener('change', ({ target }) => {
  if (target.checked) {
    selected.add(target.value);
  } else {
    selected.delete(target.value);
  }
  showSelection();
});
find('picked').addEventListener('submit', (event) => {
  event.preventDefault();
  window.location.assign(`/compare?jobs=${[...selected].join(',')}`);
});
find('compare-clear').addEventListener('click', () => {
  selected.clear();
  showSelection();
  boxes().find((box) => !box.disabled)?.focus();
});
const refresh = poll(update, '/api/v1/events', showProgress);
if (activeJobs().size > 0) {
  refresh();
}
