// Parallel coordinates, scatter and table over one selection.

import { find, make } from '../dom.js';
import { Filters, Picker } from './filters.js';
import { shadeText } from './paint.js';
import { Parallel, axesText } from './parallel.js';
import { Scatter } from './scatter.js';
import { Selection } from './selection.js';
import { DesignTable } from './table.js';

const AXES = 9; // shown unless somebody chooses others
const COLUMNS = 12;
const MOST = 12; // designs that can be compared

export class Explorer {
  constructor(designs, address, metric) {
    Object.assign(this, { designs, address, metric, picked: new Set() });
    this.selection = new Selection(designs);
    this.logarithms();
    this.setUpParallel();
    this.setUpScatter();
    this.setUpTable();
    this.filters = new Filters(designs, this.selection, address);
    this.filters.start();
    this.showLegend();
    this.showPicked();
  }

  // Columns by their keys in the address, or those that vary, up to a number.
  columnsOf(name, most) {
    const given = this.address
      .list(name)
      .map((key) => this.designs.byKey.get(key))
      .filter(Boolean);
    if (given.length > 1) {
      return given;
    }
    const { parameters, metrics } = this.designs;
    const varying = (list) => list.filter(({ varies, key }) => varies && !key.endsWith('_error'));
    const some = varying(parameters).slice(0, Math.max(most - 2, 1));
    const rest = [this.metric, ...varying(metrics).filter((column) => column !== this.metric)].filter(Boolean);
    return [...some, ...rest.slice(0, Math.min(most - some.length, 4))];
  }

  logarithms() {
    for (const key of this.address.list('log')) {
      const column = this.designs.byKey.get(key);
      if (column) {
        column.isLogarithmic = column.canBeLogarithmic;
      }
    }
  }

  setUpParallel() {
    const frame = find('parallel-plot');
    const place = make('div', { class: 'frame' });
    frame.replaceChildren(place);
    const columns = this.columnsOf('axes', AXES);
    this.parallel = new Parallel(place, this.designs, this.selection, {
      columns,
      colour: this.metric,
      onHover: (row, event) => this.point(row, event),
      onChange: () => {
        this.address.set('axes', this.parallel.columns.map(({ key }) => key).join(','));
        this.address.set(
          'log',
          this.designs.columns
            .filter(({ isLogarithmic }) => isLogarithmic)
            .map(({ key }) => key)
            .join(','),
        );
        frame.setAttribute('aria-label', axesText(this.designs, this.parallel.columns));
        this.scatter?.arrange();
      },
    });
    frame.setAttribute('aria-label', axesText(this.designs, columns));
    new Picker(
      find('axes-picker'),
      this.designs,
      columns,
      (chosen) => chosen.length > 1 && this.parallel.setColumns(chosen),
    );
  }

  setUpScatter() {
    const place = make('div', { class: 'frame' });
    find('scatter-plot').replaceChildren(place);
    const { parameters, byKey } = this.designs;
    const others = this.designs.metrics.filter((column) => column.varies && column !== this.metric);
    const x =
      byKey.get(this.address.get('x')) ??
      others.find(({ key }) => /^mass/.test(key)) ??
      parameters.find(({ varies }) => varies) ??
      parameters[0] ??
      this.metric;
    const y = byKey.get(this.address.get('y')) ?? this.metric ?? parameters[0];
    this.scatter = new Scatter(place, this.designs, this.selection, {
      x,
      y,
      colour: this.metric,
      onHover: (row, event) => this.point(row, event),
      onPick: (row) => this.pick(row, !this.picked.has(row)),
    });
    for (const [id, column, name] of [
      ['scatter-x', x, 'x'],
      ['scatter-y', y, 'y'],
    ]) {
      const select = find(id);
      select.replaceChildren(
        ...this.designs.columns.map((one) => make('option', { value: one.key, selected: one === column }, one.label)),
      );
      select.onchange = () => {
        this.address.set(name, select.value);
        this.scatter.front = [];
        this.scatter.show({ [name]: byKey.get(select.value) });
        this.showFront(this.front, this.frontKeys);
      };
    }
  }

  setUpTable() {
    const columns = this.columnsOf('columns', COLUMNS);
    find('only-differences').onchange = () => this.table.setColumns(this.shownColumns());
    this.chosenColumns = columns;
    this.table = new DesignTable({
      scroll: find('table-scroll'),
      table: find('design-table'),
      designs: this.designs,
      selection: this.selection,
      columns,
      sort: this.address.get('sort', 'member'),
      picked: this.picked,
      onSort: (sort) => this.address.set('sort', sort, 'member'),
      onPick: (row, on) => this.pick(row, on),
      onHover: (row) => this.point(row),
    });
    new Picker(find('columns-picker'), this.designs, columns, (chosen) => {
      this.chosenColumns = chosen;
      this.address.set('columns', chosen.map(({ key }) => key).join(','));
      this.table.setColumns(this.shownColumns());
    });
    find('picked-clear').onclick = () => [...this.picked].forEach((row) => this.pick(row, false));
  }

  // Those chosen, or of these only where the selected designs differ.
  shownColumns() {
    if (!find('only-differences').checked) {
      return this.chosenColumns;
    }
    const rows = this.picked.size > 1 ? [...this.picked] : this.selection.rows();
    return this.chosenColumns.filter(({ data }) => {
      const first = data[rows[0]];
      return rows.some((row) => data[row] !== first && (data[row] === data[row] || first === first));
    });
  }

  showLegend() {
    const { metric } = this;
    const bar = find('legend-bar');
    bar.style.background = `linear-gradient(to right, ${[0, 0.25, 0.5, 0.75, 1].map(shadeText).join(', ')})`;
    find('legend-title').textContent = metric?.label ?? '';
    find('legend-low').textContent = metric ? metric.text(metric.low) : '';
    find('legend-high').textContent = metric ? metric.text(metric.high) : '';
  }

  recolour(metric) {
    this.metric = metric;
    this.parallel.recolour(metric);
    this.scatter.show({ colour: metric });
    this.showLegend();
  }

  // In other colours, at once: paper does not wait for the next picture.
  repaint() {
    this.recolour(this.metric);
    this.parallel.paint();
    this.scatter.paint();
    this.table.arrange();
    this.table.fill();
  }

  // One design that is pointed at, in all views.
  point(row, event) {
    this.parallel.show(row);
    this.scatter.point(row);
    const tip = find('tip');
    tip.hidden = row < 0 || !event;
    if (!tip.hidden) {
      tip.replaceChildren(
        make('strong', {}, this.designs.label(row)),
        ...this.parallel.columns
          .slice(0, 10)
          .map((column) => make('span', {}, `${column.title} `, make('b', {}, column.textWithUnit(column.data[row])))),
      );
      const right = event.clientX + 250 > window.innerWidth;
      tip.style.left = `${event.clientX + (right ? -240 : 14)}px`;
      tip.style.top = `${Math.min(event.clientY + 14, window.innerHeight - 40 - 20 * this.parallel.columns.length)}px`;
    }
  }

  // The front is drawn when its objectives are the axes of the scatter, or nobody has chosen axes.
  showFront(rows = [], keys = []) {
    this.front = rows;
    this.frontKeys = keys;
    if (keys.length >= 2 && !this.address.get('x') && !this.address.get('y')) {
      const [y, x] = keys.map((key) => this.designs.byKey.get(key));
      find('scatter-x').value = x.key;
      find('scatter-y').value = y.key;
      this.scatter.show({ x, y });
    }
    const isShown = keys.length === 2 && keys.includes(this.scatter.x.key) && keys.includes(this.scatter.y.key);
    this.scatter.showFront(isShown ? rows : []);
  }

  pick(row, on) {
    if (on) {
      this.picked.add(row);
    } else {
      this.picked.delete(row);
    }
    document.querySelectorAll(`[data-pick="${row}"]`).forEach((box) => {
      box.checked = on;
    });
    this.table.draw();
    this.showPicked();
  }

  showPicked() {
    const rows = [...this.picked].sort((a, b) => a - b);
    find('picked').textContent =
      rows.length === 0
        ? 'Tick designs to compare them.'
        : `${rows.length} picked${rows.length > MOST ? `; up to ${MOST} can be compared` : ''}`;
    const link = find('compare-picked');
    const can = rows.length > 1 && rows.length <= MOST;
    link.hidden = !can;
    link.href = can ? `/compare?jobs=${rows.map((row) => this.designs.jobs[row]).join(',')}` : '';
    find('picked-clear').hidden = rows.length === 0;
  }

  // The same study with designs that are new.
  take(designs) {
    const { ranges, scroll } = { ranges: this.selection.ranges(), scroll: find('table-scroll').scrollTop };
    const { picked } = this;
    this.retire();
    Object.assign(this, new Explorer(designs, this.address, designs.byKey.get(this.metric?.key)));
    ranges.forEach(([key, low, high]) => this.selection.limit(key, [low, high]));
    picked.forEach((row) => this.pick(row, true));
    find('table-scroll').scrollTop = scroll;
  }

  retire() {
    this.selection.listeners.length = 0;
  }
}
