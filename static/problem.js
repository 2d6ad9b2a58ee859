// Showing a refusal: what was wrong, where, and the place in the text.

import { make } from './dom.js';

function capital(text) {
  return text.charAt(0).toUpperCase() + text.slice(1);
}

function excerpt(text, line, column) {
  const source = text.split('\n')[line - 1];
  if (source === undefined) {
    return null;
  }
  // a long line is shown around the place
  const start = Math.max(0, column - 60);
  const shown = source.slice(start, start + 100).replaceAll('\t', ' ');
  const number = String(line);
  const caret = ' '.repeat(number.length + 3 + Math.max(0, column - 1 - start));
  return make('pre', {}, `${number} | ${shown}\n${caret}^`);
}

// Elements that describe a Problem. `text` is the document it is about, if any.
export function problemView(problem, text = '') {
  const { title, detail, pointer, line, column } = problem.body || {};
  const view = make('div', { class: 'problem' },
    make('p', {}, make('strong', {}, capital(title || 'that did not work'))),
    make('p', {}, capital(detail || problem.message)));
  const places = [];
  if (pointer) {
    places.push(make('dt', {}, 'Where'), make('dd', {}, make('code', { class: 'pointer' }, pointer)));
  }
  if (line > 0) {
    places.push(make('dt', {}, 'Place'),
      make('dd', { class: 'place' }, `line ${line}, column ${column}`));
  }
  if (places.length > 0) {
    view.append(make('dl', {}, ...places));
  }
  const source = line > 0 && text ? excerpt(text, line, column || 1) : null;
  if (source) {
    view.append(source);
  }
  return view;
}

// Shows a problem in its place on the page, or clears it with null.
export function showProblem(place, problem, text) {
  place.hidden = problem === null;
  place.replaceChildren(...(problem ? [problemView(problem, text)] : []));
}
