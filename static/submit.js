// The page where jobs are written: the daemon checks the text while it is written, what is wrong is shown
// at its line and at its field, and the fields beside the text change it.

import { post, request } from './api.js';
import { find, make } from './dom.js';
import { Editor } from './editor.js';
import { finger, grasp } from './example.js';
import { Fields } from './fields.js';
import { remember } from './live.js';
import { problemView } from './problem.js';

const CHECK_MS = 350; // after the last key

const editor = new Editor(find('document'), find('gutter'));
const verdict = find('verdict');
let fields = null;
let checking = 0;
let timer = null;

function show(element, isWrong = false) {
  verdict.classList.toggle('bad', isWrong);
  verdict.replaceChildren(element);
}

function showProblem(problem) {
  const { pointer, line, column, detail } = problem.body || {};
  editor.mark(line > 0 ? line : 0);
  fields?.mark(pointer ?? null, detail || problem.message);
  const view = problemView(problem, editor.text);
  if (line > 0) {
    const button = make('button', { type: 'button' }, 'Go to this place');
    button.addEventListener('click', () => editor.go(line, column || 1));
    view.append(button);
  }
  show(view, true);
}

function showValid({ kind }) {
  editor.mark(0);
  fields?.mark(null);
  show(make('p', { class: 'answer' }, `This job (${kind}) is valid.`));
}

// Asks the daemon about the text. An answer that is overtaken by another question is dropped.
async function check() {
  const number = ++checking;
  fields?.show(editor.text);
  if (editor.text.trim() === '') {
    editor.mark(0);
    show(make('p', { class: 'muted' }, 'Write a job, or start from an example.'));
    return;
  }
  try {
    const answer = await post('/api/v1/jobs:validate', editor.text);
    if (number === checking) {
      showValid(answer);
    }
  } catch (problem) {
    if (number === checking) {
      showProblem(problem);
    }
  }
}

function checkSoon() {
  clearTimeout(timer);
  timer = setTimeout(check, CHECK_MS);
}

async function submit(event) {
  event.preventDefault();
  const button = find('submit-form').querySelector('.primary');
  button.disabled = true;
  try {
    const job = await post('/api/v1/jobs', editor.text || ' ');
    find('submit-answer').replaceChildren(make('p', { class: 'answer' }, 'Accepted as ',
      make('a', { href: `/jobs/${job.id}` }, `job ${job.id}`), '.'));
  } catch (problem) {
    find('submit-answer').replaceChildren();
    showProblem(problem);
  } finally {
    button.disabled = false;
  }
}

// A document of one line is laid out so that a person can read it.
function layOut() {
  const text = editor.text.trim();
  if (text !== '' && !text.includes('\n')) {
    try {
      editor.area.value = JSON.stringify(JSON.parse(text), null, 2);
      editor.number();
    } catch {
      // it stays as it is; the check says what is wrong
    }
  }
}

async function setUp() {
  remember();
  layOut();
  find('submit-form').addEventListener('submit', submit);
  editor.area.addEventListener('input', checkSoon);
  for (const [id, text] of [['example', finger], ['example-grasp', grasp]]) {
    find(id).addEventListener('click', () => {
      editor.text = text;
      check();
    });
  }
  try {
    fields = new Fields(find('fields'), await request('/api/v1/schemas/job'), (text) => {
      editor.text = text;
      check();
    });
  } catch (problem) {
    showProblem(problem);
  }
  check();
}

setUp();
