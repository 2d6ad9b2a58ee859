// The box where a job is pasted, checked and submitted.

import { post } from './api.js';
import { find, make } from './dom.js';
import { example } from './example.js';
import { problemView } from './problem.js';

// Puts the cursor where the daemon found the mistake.
function select(area, line, column) {
  const before = area.value.split('\n').slice(0, line - 1);
  const start = before.reduce((sum, text) => sum + text.length + 1, 0) + Math.max(0, column - 1);
  area.focus();
  area.setSelectionRange(start, Math.min(start + 1, area.value.length));
}

function refusal(problem, area) {
  const view = problemView(problem, area.value);
  const { line, column } = problem.body;
  if (line > 0) {
    const button = make('button', { type: 'button' }, 'Go to this place');
    button.addEventListener('click', () => select(area, line, column || 1));
    view.append(button);
  }
  return view;
}

// Sets up the form; onSubmitted is called after each accepted job.
export function setUpSubmit(onSubmitted) {
  const area = find('document');
  const answer = find('submit-answer');
  const buttons = find('submit-form').querySelectorAll('button');

  async function send(url, accepted) {
    buttons.forEach((button) => { button.disabled = true; });
    answer.replaceChildren(make('p', { class: 'muted' }, 'Sending…'));
    try {
      answer.replaceChildren(accepted(await post(url, area.value || ' ')));
    } catch (problem) {
      answer.replaceChildren(refusal(problem, area));
    } finally {
      buttons.forEach((button) => { button.disabled = false; });
    }
  }

  find('submit-form').addEventListener('submit', (event) => {
    event.preventDefault();
    send('/api/v1/jobs', (job) => {
      onSubmitted();
      return make('p', { class: 'answer' }, 'Accepted as ',
        make('a', { href: `/jobs/${job.id}` }, `job ${job.id}`), '.');
    });
  });
  find('validate').addEventListener('click', () => {
    send('/api/v1/jobs:validate', () => make('p', { class: 'answer' }, 'This job is valid.'));
  });
  find('example').addEventListener('click', () => {
    area.value = example;
    area.focus();
  });
}
