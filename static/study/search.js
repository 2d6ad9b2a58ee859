// "Which designs reach at least 60° with the least mass?" Stored designs answer first; predicted ones are
// marked as such until one click has them solved.

import { find, make } from '../dom.js';
import { number } from '../format.js';
import { showProblem } from '../problem.js';
import { analysis, confirm } from './source.js';
import { tickText } from './ticks.js';

// What solving a predicted design says, at its place.
export async function solve(values, button, place) {
  button.disabled = true;
  try {
    const job = await confirm(values);
    button.replaceWith(make('a', { href: `/jobs/${job.id}` }, `Job ${job.id}`));
    showProblem(place, null);
  } catch (problem) {
    button.disabled = false;
    showProblem(place, problem);
  }
}

// The parameters of a design in one line.
export function designText(designs, values) {
  return Object.entries(values)
    .map(([key, value]) => {
      const column = designs.byKey.get(key);
      return column
        ? `${column.title} ${typeof value === 'number' ? `${number(value)}\u00a0${column.unit}`.trim() : value}`
        : '';
    })
    .filter(Boolean)
    .join(', ');
}

export class Search {
  constructor(designs, address, usual) {
    Object.assign(this, { designs, address });
    const options = () =>
      designs.metrics.filter(({ varies }) => varies).map(({ key, label }) => make('option', { value: key }, label));
    find('search-metric').replaceChildren(...options());
    find('search-goal').replaceChildren(...options());
    find('search-metric').value = address.get('want', usual.metric);
    find('search-goal').value = address.get('goal', usual.goal);
    find('search-limit').value = address.get('limit');
    find('search-way').value = address.get('way', 'least');
    find('search-form').onsubmit = (event) => {
      event.preventDefault();
      this.run();
    };
    if (address.get('limit')) {
      this.run();
    }
  }

  async run() {
    const metric = find('search-metric').value;
    const limit = find('search-limit').value.trim();
    const goal = find('search-goal').value;
    const way = find('search-way').value;
    const sign = find('search-sign').value;
    this.address.set('want', metric);
    this.address.set('limit', limit);
    this.address.set('goal', goal);
    this.address.set('way', way, 'least');
    find('search-results').setAttribute('aria-busy', 'true');
    try {
      const answer = await analysis('search', { where: limit ? `${metric}${sign}${limit}` : '', [way]: goal });
      showProblem(find('search-problem'), null);
      this.show(answer);
    } catch (problem) {
      showProblem(find('search-problem'), problem);
    }
    find('search-results').removeAttribute('aria-busy');
  }

  show(answer) {
    const { metrics } = answer;
    const head = make(
      'thead',
      {},
      make(
        'tr',
        {},
        make('th', { scope: 'col' }, 'Design'),
        ...metrics.map(({ title, unit }) =>
          make('th', { scope: 'col', class: 'number' }, title, make('span', { class: 'unit' }, unit || '\u00a0')),
        ),
        make('th', { scope: 'col' }, 'How it is known'),
      ),
    );
    const rows = [
      ...answer.stored.slice(0, 5).map((one) => this.line(one, metrics)),
      ...answer.predicted.slice(0, 5).map((one) => this.line(one, metrics)),
    ];
    find('search-table').replaceChildren(head, make('tbody', {}, ...rows));
    find('search-text').textContent =
      rows.length === 0
        ? 'No design does, and none is expected to.'
        : `${answer.meeting} stored ${answer.meeting === 1 ? 'design does' : 'designs do'}; the best of them first, then what is expected of others.`;
  }

  line(one, metrics) {
    const values = metrics.map(({ key }) => one.metrics.find((metric) => metric.key === key));
    const cells = values.map((metric) =>
      make(
        'td',
        { class: 'number' },
        number(metric?.value),
        typeof metric?.deviation === 'number'
          ? make('span', { class: 'muted' }, ` ± ${tickText(Number((1.96 * metric.deviation).toPrecision(2)))}`)
          : null,
      ),
    );
    return make(
      'tr',
      { class: one.predicted ? 'predicted' : null },
      make(
        'th',
        { scope: 'row' },
        one.predicted
          ? designText(this.designs, one.values)
          : make('a', { href: `/jobs/${one.job}` }, one.name || `design ${one.member}`),
      ),
      ...cells,
      this.source(one),
    );
  }

  source(one) {
    if (!one.predicted) {
      return make('td', {}, make('span', { class: 'state succeeded' }, 'solved'));
    }
    if (one.solved) {
      return make(
        'td',
        {},
        make('a', { href: `/jobs/${one.solved.job}` }, `Job ${one.solved.job}: ${one.solved.state}`),
      );
    }
    const button = make('button', { type: 'button', class: 'small', 'data-confirm': true }, 'Solve it');
    button.addEventListener('click', () => solve(one.values, button, find('search-problem')));
    const chance = typeof one.chance === 'number' ? ` ${Math.round(100 * one.chance)} %` : '';
    return make('td', {}, make('span', { class: 'state predicted' }, `predicted${chance}`), ' ', button);
  }
}
