// The filter that people type, the ranges that are in force, and which columns are shown where.

import { find, make, setText } from '../dom.js';
import { readFilter } from './expression.js';

export class Filters {
  constructor(designs, selection, address) {
    Object.assign(this, { designs, selection, address });
    const input = find('filter');
    input.value = address.get('filter');
    input.oninput = () => this.read();
    find('clear').onclick = () => {
      input.value = '';
      this.read();
      this.selection.clear();
    };
    selection.listen(() => this.follow());
  }

  // Puts what the address says into force.
  start() {
    for (const [key, low, high] of this.address.ranges()) {
      this.selection.limit(key, [low, high]);
    }
    this.read();
    this.follow();
  }

  read() {
    const input = find('filter');
    try {
      this.selection.filter(readFilter(this.designs, input.value));
      input.removeAttribute('aria-invalid');
      setText(find('filter-problem'), '');
      this.address.set('filter', input.value);
    } catch (problem) {
      if (!(problem instanceof SyntaxError)) {
        throw problem;
      }
      input.setAttribute('aria-invalid', 'true');
      setText(find('filter-problem'), `${problem.message}.`);
    }
  }

  follow() {
    const { designs, selection } = this;
    const ranges = selection.ranges();
    setText(
      find('selected'),
      selection.count === designs.count
        ? `all ${designs.count} designs`
        : `${selection.count} of ${designs.count} designs`,
    );
    find('clear').disabled = selection.limits.size === 0;
    this.showRanges(ranges);
    this.address.setRanges(ranges);
  }

  showRanges(ranges) {
    const place = find('ranges');
    while (place.children.length > ranges.length) {
      place.lastElementChild.remove();
    }
    ranges.forEach(([key, low, high], i) => {
      const column = this.designs.byKey.get(key);
      const ends = column.words
        ? column.words.slice(Math.ceil(Math.max(low, 0)), Math.floor(high) + 1).join(', ')
        : `${column.text(low)} – ${column.textWithUnit(high)}`;
      let chip = place.children[i];
      if (!chip) {
        chip = make('button', { type: 'button', class: 'chip' });
        place.append(chip);
      }
      chip.onclick = () => this.selection.limit(key, null);
      chip.dataset.key = key;
      chip.title = 'Take this range away';
      setText(chip, `${column.title}: ${ends} ×`);
    });
  }
}

// A list of boxes for columns; onChange gets the columns that are ticked, in the order of the designs.
export class Picker {
  constructor(place, designs, chosen, onChange) {
    const ticked = new Set(chosen);
    place.replaceChildren(
      ...[
        ['Parameters', designs.parameters],
        ['Metrics', designs.metrics],
      ].map(([title, columns]) =>
        make(
          'fieldset',
          {},
          make('legend', {}, title),
          ...columns.map((column) => {
            const box = make('input', { type: 'checkbox' });
            box.checked = ticked.has(column);
            box.addEventListener('change', () => {
              if (box.checked) {
                ticked.add(column);
              } else {
                ticked.delete(column);
              }
              onChange(designs.columns.filter((one) => ticked.has(one)));
            });
            return make('label', { class: 'inline' }, box, column.label);
          }),
        ),
      ),
    );
  }
}
