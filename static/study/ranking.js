// Designs in the order of a weighted mean of their normalised metrics.

import { find, make } from '../dom.js';
import { offered } from './offer.js';
import { SERIES } from './paint.js';
import { Panel } from './panel.js';
import { analysis } from './source.js';

const SHOWN = 15;
const PAUSE_MS = 120;

export class Ranking {
  // usual: [["max", key, weight]] unless the address has others; hasPreset: the study ranks by itself.
  constructor(designs, address, usual, hasPreset) {
    Object.assign(this, { designs, address });
    this.hasPreset = hasPreset;
    const given = address
      .list('rank')
      .map((part) => part.split(':'))
      .filter(([, key]) => designs.byKey.has(key));
    this.criteria = new Map(
      (given.length > 0 ? given : usual).map(([way, key, weight]) => [key, [way, Number(weight) || 1]]),
    );
    this.isPreset = hasPreset && given.length === 0;
    this.isChosen = given.length > 0;
    this.showPreset();
    find('ranking-preset').onchange = () => {
      this.isPreset = find('ranking-preset').checked;
      this.showWeights();
      this.renew();
    };
    this.showWeights();
    this.panel = new Panel(
      'ranking',
      () => this.ask(),
      (answer) => this.show(answer),
    );
  }

  showPreset() {
    find('ranking-preset').closest('label').hidden = !this.hasPreset;
    find('ranking-preset').checked = this.isPreset;
  }

  // The study has a ranking of its own: it is shown unless somebody chose weights.
  offerPreset() {
    this.hasPreset = true;
    this.isPreset = !this.isChosen;
    this.showPreset();
    this.showWeights();
    this.renew();
  }

  renew() {
    return this.panel.renew();
  }

  retire() {
    this.panel.retire();
  }

  showWeights() {
    find('ranking-weights').hidden = this.isPreset;
    find('ranking-weights').replaceChildren(
      ...offered(
        this.designs,
        this.criteria,
        (key) => {
          this.criteria.set(key, ['max', 1]);
          this.showWeights();
          this.follow();
        },
        (column) => this.weight(column),
      ),
    );
  }

  weight(column) {
    const [way, weight] = this.criteria.get(column.key) ?? ['', 1];
    const id = `weight-${column.index}`;
    const select = make(
      'select',
      { 'aria-label': `Direction of ${column.title}` },
      make('option', { value: '' }, 'ignore'),
      make('option', { value: 'max' }, 'most'),
      make('option', { value: 'min' }, 'least'),
    );
    select.value = way;
    const range = make('input', {
      id,
      type: 'range',
      min: 0.1,
      max: 5,
      step: 0.1,
      value: weight,
      disabled: way === '',
    });
    const follow = () => {
      range.disabled = select.value === '';
      if (select.value) {
        this.criteria.set(column.key, [select.value, Number(range.value)]);
      } else {
        this.criteria.delete(column.key);
      }
      this.follow();
    };
    select.addEventListener('change', follow);
    range.addEventListener('input', follow);
    return make('div', { class: 'slider weight' }, make('label', { for: id }, column.title), select, range);
  }

  follow() {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => {
      this.address.set('rank', this.text());
      this.renew();
    }, PAUSE_MS);
  }

  text() {
    return [...this.criteria].map(([key, [way, weight]]) => `${way}:${key}:${weight}`).join(',');
  }

  ask() {
    if (this.isPreset) {
      return analysis('ranking', { preset: 'taper', limit: SHOWN });
    }
    return this.criteria.size === 0
      ? Promise.reject(new Error('Choose what counts.'))
      : analysis('ranking', { criteria: this.text(), limit: SHOWN });
  }

  // Bars of what each criterion adds, the best design first.
  show({ criteria, designs, compared }) {
    const rowOf = new Map(this.designs.jobs.map((job, row) => [job, row]));
    find('ranking-legend').replaceChildren(
      ...criteria.map(({ title, weight }, i) => {
        const key = make('span', { class: 'key' });
        key.style.background = SERIES[i % SERIES.length];
        return make('li', {}, key, `${title} ${Math.round(100 * weight)} %`);
      }),
    );
    const most = Math.max(...designs.map(({ score }) => score), 1e-9);
    find('ranking-list').replaceChildren(
      ...designs.map((design) => {
        const bar = make(
          'span',
          { class: 'bar-of-parts', 'aria-hidden': 'true' },
          ...design.parts.map((part, i) => {
            const share = make('span');
            share.style.width = `${(100 * Math.max(part * criteria[i].weight, 0)) / most}%`;
            share.style.background = SERIES[i % SERIES.length];
            return share;
          }),
        );
        const row = rowOf.get(design.job);
        return make(
          'li',
          { value: design.rank },
          make(
            'a',
            { href: `/jobs/${design.job}`, title: design.name },
            row === undefined ? design.name : this.designs.label(row),
          ),
          bar,
          make('span', { class: 'number' }, design.score.toFixed(3)),
        );
      }),
    );
    find('ranking-text').textContent = `${compared} designs compared; 1 is the best in everything.`;
  }
}
