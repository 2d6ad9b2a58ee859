// Choosing objectives, and the designs that no other one beats in all of them.

import { find, make } from '../dom.js';
import { number } from '../format.js';
import { offered } from './offer.js';
import { Panel } from './panel.js';
import { analysis } from './source.js';

// "max:bending_angle_deg,min:mass_g" -> [["max", "bending_angle_deg"], ...], of metrics that there are.
export function readObjectives(text, designs) {
  return text
    .split(',')
    .map((part) => part.split(':'))
    .filter(([direction, key]) => ['max', 'min'].includes(direction) && designs.byKey.has(key));
}

export class Pareto {
  // usual: the objectives unless the address has others. onFront(rows, objectives): another front.
  constructor(designs, address, usual, { onFront, onPick, onHover }) {
    Object.assign(this, { designs, address, onFront, onPick, onHover });
    const given = readObjectives(address.get('pareto'), designs);
    this.objectives = new Map((given.length > 0 ? given : usual).map(([direction, key]) => [key, direction]));
    this.showChoice();
    this.panel = new Panel(
      'pareto',
      () => this.ask(),
      (answer) => this.show(answer),
    );
  }

  showChoice() {
    const choice = (column) => {
      const id = `objective-${column.index}`;
      const select = make(
        'select',
        { id },
        make('option', { value: '' }, 'ignore'),
        make('option', { value: 'max' }, 'most'),
        make('option', { value: 'min' }, 'least'),
      );
      select.value = this.objectives.get(column.key) || '';
      select.addEventListener('change', () => this.choose(column.key, select.value));
      return make('div', { class: 'choice' }, make('label', { for: id }, column.title), select);
    };
    find('objectives').replaceChildren(
      ...offered(
        this.designs,
        this.objectives,
        (key) => {
          this.choose(key, 'max');
          this.showChoice();
        },
        choice,
      ),
    );
  }

  choose(key, direction) {
    if (direction) {
      this.objectives.set(key, direction);
    } else {
      this.objectives.delete(key);
    }
    this.address.set('pareto', [...this.objectives].map(([name, way]) => `${way}:${name}`).join(','));
    this.panel.renew();
  }

  ask() {
    if (this.objectives.size === 0) {
      return Promise.reject(new Error('Choose what is wanted most or least.'));
    }
    const objectives = [...this.objectives].map(([key, direction]) => `${direction}:${key}`).join(',');
    return analysis('pareto', { objectives });
  }

  show(answer) {
    this.rowOf = new Map(this.designs.jobs.map((job, row) => [job, row]));
    const first = answer.designs.filter(({ layer }) => layer === 1);
    const [head] = answer.objectives;
    const sign = head.direction === 'max' ? -1 : 1;
    first.sort((a, b) => sign * (a.values[0] - b.values[0]));
    const wanted = answer.objectives
      .map(({ direction, title }) => `${direction === 'max' ? 'most' : 'least'} ${title}`)
      .join(', ');
    find('pareto-text').textContent = `${first.length} of ${answer.compared} designs are beaten by none (${wanted}).`;
    const heading = answer.objectives.map(({ title, unit }) =>
      make('th', { scope: 'col', class: 'number' }, title, make('span', { class: 'unit' }, unit || '\u00a0')),
    );
    const known = first.filter(({ job }) => this.rowOf.has(job)); // others came since
    const rows = known.slice(0, 100).map((design) => this.line(design));
    find('pareto-table').replaceChildren(
      make(
        'thead',
        {},
        make(
          'tr',
          {},
          make('th', { scope: 'col' }, make('span', { class: 'quiet' }, 'Pick')),
          make('th', { scope: 'col' }, 'Design'),
          ...heading,
        ),
      ),
      make('tbody', {}, ...rows),
    );
    this.onFront(
      known.map(({ job }) => this.rowOf.get(job)),
      answer.objectives.map(({ key }) => key),
    );
  }

  line(design) {
    const row = this.rowOf.get(design.job);
    const name = this.designs.label(row);
    const box = make('input', { type: 'checkbox', 'aria-label': `Pick ${name}`, 'data-pick': row });
    box.addEventListener('change', () => this.onPick(row, box.checked));
    const line = make(
      'tr',
      {},
      make('td', {}, box),
      make('th', { scope: 'row' }, make('a', { href: `/jobs/${design.job}`, title: this.designs.name(row) }, name)),
      ...design.values.map((value) => make('td', { class: 'number' }, number(value))),
    );
    line.addEventListener('pointerenter', () => this.onHover(row));
    line.addEventListener('pointerleave', () => this.onHover(-1));
    return line;
  }
}
