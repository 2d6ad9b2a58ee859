// A few metrics to choose from, and a way to the others.

import { make } from '../dom.js';
import { byImportance } from '../format.js';

const FIRST = 5;

// Controls, made by control(column), for the metrics of most interest and those that are chosen (a Map by
// key), and a list that adds one of the others.
export function offered(designs, chosen, add, control) {
  const metrics = designs.metrics
    .filter(({ varies, key }) => varies && !key.endsWith('_error'))
    .sort((a, b) => byImportance(a.key, b.key));
  const shown = metrics.filter(({ key }, i) => i < FIRST || chosen.has(key));
  const others = metrics.filter((column) => !shown.includes(column));
  if (others.length === 0) {
    return shown.map(control);
  }
  const select = make(
    'select',
    { 'aria-label': 'Another metric', class: 'more' },
    make('option', { value: '' }, 'another metric …'),
    ...others.map(({ key, title }) => make('option', { value: key }, title)),
  );
  select.addEventListener('change', () => select.value && add(select.value));
  return [...shown.map(control), select];
}
