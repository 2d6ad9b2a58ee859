// Several jobs side by side: one plot, one table.

import { jobUrl, request } from './api.js';
import { find, make } from './dom.js';
import { number, quantity } from './format.js';
import { showProblem } from './problem.js';

// The metrics of all jobs, in the order in which the first job has them.
function tableOf(jobs) {
  const keys = [...new Set(jobs.flatMap((job) => Object.keys(job.metrics || {})))];
  const head = make('tr', {}, make('th', { scope: 'col' }, 'Metric'),
    make('th', { scope: 'col' }, 'Unit'),
    ...jobs.map((job) => make('th', { scope: 'col', class: 'number' },
      make('a', { href: `/jobs/${job.id}` }, `Job ${job.id}`),
      make('span', { class: 'job-name clamp', title: job.name }, job.name || '–'))));
  const rows = keys.map((key) => {
    const { label, unit } = quantity(key);
    return make('tr', {}, make('th', { scope: 'row' }, label),
      make('td', { class: 'unit' }, unit),
      ...jobs.map((job) => make('td', { class: 'number' }, number((job.metrics || {})[key]))));
  });
  return [make('thead', {}, head), make('tbody', {}, ...rows)];
}

// Shows the comparison of the jobs with these ids; hides it when there are fewer than two.
export async function showComparison(ids) {
  const section = find('compare');
  section.hidden = ids.length < 2;
  if (section.hidden) {
    return;
  }
  const plot = `/api/v1/plots/overlay.png?jobs=${ids.join(',')}`;
  const image = find('compare-plot');
  if (image.getAttribute('src') !== plot) {
    image.alt = `Bending angle against pressure of the jobs ${ids.join(', ')}`;
    image.src = plot;
    find('compare-link').href = plot;
  }
  try {
    const jobs = await Promise.all(ids.map((id) => request(jobUrl(id))));
    find('compare-table').replaceChildren(...tableOf(jobs));
    showProblem(find('compare-problem'), null);
  } catch (problem) {
    showProblem(find('compare-problem'), problem);
  }
}
