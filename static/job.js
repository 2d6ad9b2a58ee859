// The page of one job, as the daemon made it: it is kept up to date while the job runs, the buttons act,
// and the deformed body can be turned.

import { jobUrl, post } from './api.js';
import { find, setText } from './dom.js';
import { number } from './format.js';
import { remember, renew } from './live.js';
import { poll } from './poll.js';
import { showProblem } from './problem.js';

const id = window.location.pathname.split('/').filter(Boolean).pop();

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
  const bar = find('progress');
  if (!bar) {
    return;
  }
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
  bar.value = share;
  setText(find('percent'), parts.filter(Boolean).join(' · '));
}

async function act(button) {
  const name = button.dataset.action;
  button.disabled = true;
  try {
    const answer = await post(jobUrl(id, `/${name}`));
    showProblem(find('action-problem'), null);
    if (name === 'retry' && answer.id && String(answer.id) !== id) {
      window.location.assign(`/jobs/${answer.id}`);
      return;
    }
  } catch (problem) {
    showProblem(find('action-problem'), problem);
    button.disabled = false;
  }
  refresh();
}

// The view needs a library of its own: only pages that have a body load it.
async function showShape() {
  if (find('shape')) {
    const { setUpShape } = await import('./shape.js');
    await setUpShape(find('shape'));
  }
}

async function update() {
  try {
    const changed = await renew();
    showProblem(find('action-problem'), null);
    if (changed.includes('outcome')) {
      showShape();
    }
  } catch (problem) {
    showProblem(find('action-problem'), problem);
    return true;
  }
  return find('state-bar').hasAttribute('data-active');
}

remember();
document.addEventListener('click', ({ target }) => {
  const button = target.closest('[data-action]');
  if (button) {
    act(button);
  }
});
const refresh = poll(update, `/api/v1/events?job=${encodeURIComponent(id)}`, showProgress);
if (find('state-bar').hasAttribute('data-active')) {
  refresh();
}
showShape();
