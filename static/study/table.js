// The designs as a table of which only the rows in sight exist.

import { make, setText } from '../dom.js';
import { stateWord } from '../format.js';
import { eachFrame } from './canvas.js';

const ROW = 34; // pixels of a row, as style sheet and this agree
const SPARE = 6; // rows above and below those in sight

export class DesignTable {
  // table: an empty <table> within `scroll`, which scrolls. picked: a Set of rows.
  constructor({ scroll, table, designs, selection, columns, sort, picked, onSort, onPick, onHover }) {
    Object.assign(this, { scroll, table, designs, selection, columns, sort, picked, onSort, onPick, onHover });
    this.head = make('thead');
    this.body = make('tbody');
    table.replaceChildren(this.head, this.body);
    this.draw = eachFrame(() => this.fill(), scroll);
    this.order = eachFrame(() => this.arrange(), scroll);
    this.rows = new Uint32Array(0);
    this.lines = [];
    selection.listen(() => this.order());
    scroll.onscroll = () => this.draw();
    this.body.addEventListener('pointerover', (event) => {
      const line = event.target.closest('tr[data-row]');
      this.onHover(line ? Number(line.dataset.row) : -1);
    });
    this.body.addEventListener('pointerleave', () => this.onHover(-1));
    this.body.addEventListener('change', (event) => {
      this.onPick(Number(event.target.closest('tr').dataset.row), event.target.checked);
    });
    new ResizeObserver(() => this.draw()).observe(scroll);
    this.setColumns(columns);
  }

  setColumns(columns) {
    this.columns = columns;
    this.lines = [];
    this.body.replaceChildren();
    this.showHead();
    this.arrange();
  }

  showHead() {
    const heading = (key, label, unit, className) => {
      const [, sign, sorted] = /^(-?)(.*)$/.exec(this.sort);
      const isSorted = sorted === key;
      const button = make(
        'button',
        { type: 'button', class: 'sort', title: key },
        label,
        isSorted ? make('span', { 'aria-hidden': 'true' }, sign ? ' ▾' : ' ▴') : null,
      );
      button.addEventListener('click', () => this.setSort(isSorted && !sign ? `-${key}` : key));
      return make(
        'th',
        { scope: 'col', class: className, 'aria-sort': isSorted ? (sign ? 'descending' : 'ascending') : null },
        button,
        make('span', { class: 'unit' }, unit || '\u00a0'),
      );
    };
    this.head.replaceChildren(
      make(
        'tr',
        {},
        make('th', { scope: 'col' }, make('span', { class: 'quiet' }, 'Pick')),
        heading('member', 'Design', '', ''),
        heading('state', 'State', '', ''),
        ...this.columns.map((column) =>
          heading(
            column.key,
            column.title,
            column.unit,
            `${column.words ? '' : 'number'}${column.isParameter ? ' is-parameter' : ''}`,
          ),
        ),
      ),
    );
  }

  setSort(sort) {
    this.sort = sort;
    const focused = document.activeElement?.title;
    this.showHead();
    [...this.head.querySelectorAll('button')].find(({ title }) => title === focused)?.focus();
    this.arrange();
    this.scroll.scrollTop = 0;
    this.onSort(sort);
  }

  // Puts the selected rows into order.
  arrange() {
    const { designs, selection } = this;
    const rows = selection.rows();
    const [, sign, key] = /^(-?)(.*)$/.exec(this.sort);
    const data = key === 'state' ? designs.states : designs.byKey.get(key)?.data;
    const turn = sign ? -1 : 1;
    if (data) {
      // those without a value are last in either order
      rows.sort((a, b) => {
        const x = data[a];
        const y = data[b];
        if (x === y) {
          return a - b;
        }
        return x === x && y === y ? turn * (x - y) : x === x ? -1 : y === y ? 1 : a - b;
      });
    } else if (sign) {
      rows.reverse();
    }
    this.rows = rows;
    this.table.setAttribute('aria-rowcount', rows.length + 1);
    this.draw();
  }

  fill() {
    const { scroll, rows } = this;
    const first = Math.max(Math.min(Math.floor(scroll.scrollTop / ROW) - SPARE, rows.length - 1), 0);
    const count = Math.min(Math.ceil(scroll.clientHeight / ROW) + 2 * SPARE, rows.length - first);
    while (this.lines.length < count) {
      this.lines.push(this.makeLine());
    }
    while (this.lines.length > Math.max(count, 0)) {
      this.lines.pop().element.remove();
    }
    if (!this.above) {
      this.above = make('tr', { 'aria-hidden': 'true', class: 'spacer' });
      this.below = make('tr', { 'aria-hidden': 'true', class: 'spacer' });
    }
    this.above.style.height = `${first * ROW}px`;
    this.below.style.height = `${(rows.length - first - count) * ROW}px`;
    this.lines.forEach((line, i) => this.fillLine(line, rows[first + i], first + i));
    const wanted = [this.above, ...this.lines.map(({ element }) => element), this.below];
    if (wanted.length !== this.body.children.length || wanted.some((row, i) => row !== this.body.children[i])) {
      this.body.replaceChildren(...wanted);
    }
  }

  makeLine() {
    const box = make('input', { type: 'checkbox' });
    const link = make('a');
    const state = make('span');
    const cells = this.columns.map((column) => make('td', { class: column.words ? '' : 'number' }));
    const element = make(
      'tr',
      {},
      make('td', {}, box),
      make('th', { scope: 'row' }, link),
      make('td', {}, state),
      ...cells,
    );
    return { element, box, link, state, cells, row: -1 };
  }

  fillLine(line, row, place) {
    const { designs } = this;
    const name = designs.label(row);
    line.element.dataset.row = row;
    line.element.setAttribute('aria-rowindex', place + 2);
    line.box.checked = this.picked.has(row);
    line.box.setAttribute('aria-label', `Pick ${name}`);
    if (line.row === row && line.version === designs.version) {
      return;
    }
    line.row = row;
    line.version = designs.version;
    setText(line.link, name);
    line.link.href = `/jobs/${designs.jobs[row]}`;
    line.link.title = designs.name(row);
    line.state.className = `state ${designs.state(row)}`;
    setText(line.state, stateWord(designs.state(row)));
    line.state.title = designs.reasons[row] || '';
    this.columns.forEach((column, i) => setText(line.cells[i], column.text(column.data[row])));
  }
}
