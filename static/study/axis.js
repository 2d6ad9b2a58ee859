// The head and the brush of an axis of the parallel coordinates.

import { make } from '../dom.js';

const WIDEST = 116; // pixels of a head, so that the last one is within the plot
const STEP = 0.02; // of the axis, with a key
const REACH = 16; // pixels to both sides of an axis where a brush begins
const EDGE = 7; // pixels at an end of a brush where that end is taken

export class AxisHead {
  constructor(plot, column, index) {
    Object.assign(this, { plot, column, index });
    const x = plot.x(index);
    this.name = make(
      'button',
      {
        type: 'button',
        class: 'axis-name',
        title: `${column.label}. Drag or use ← and → to move the axis${
          column.canBeLogarithmic ? '; press L for a logarithmic scale' : ''
        }.`,
      },
      make('span', { class: 'axis-title' }, column.title),
      make(
        'span',
        { class: 'axis-unit' },
        [column.unit, column.isLogarithmic ? 'log' : ''].filter(Boolean).join(' · ') || '\u00a0',
      ),
    );
    this.track = make('div', {
      class: 'axis-track',
      role: 'slider',
      tabindex: 0,
      'aria-orientation': 'vertical',
      'aria-label': `Range of ${column.label}`,
      'aria-valuemin': 0,
      'aria-valuemax': 100,
    });
    this.brush = make('div', { class: 'axis-brush', hidden: true });
    this.track.append(this.brush);
    this.element = make(
      'div',
      { class: `axis-head ${column.isParameter ? 'is-parameter' : 'is-metric'}` },
      this.name,
      this.track,
    );
    this.element.style.left = `${x}px`;
    this.element.style.width = `${Math.min(Math.max((plot.width - 120) / Math.max(plot.columns.length - 1, 1) - 6, 44), WIDEST)}px`;
    this.track.style.height = `${plot.inner}px`;
    plot.place.append(this.element);
    this.name.addEventListener('keydown', (event) => this.nameKey(event));
    this.name.addEventListener('pointerdown', (event) => this.dragName(event));
    this.track.addEventListener('keydown', (event) => this.brushKey(event));
    this.track.addEventListener('pointerdown', (event) => this.dragBrush(event));
    this.follow();
  }

  remove() {
    this.element.remove();
  }

  focus() {
    this.name.focus({ preventScroll: true });
  }

  // ---- order and scale ---------------------------------------------------------------------------

  nameKey(event) {
    const by = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (by) {
      event.preventDefault();
      this.plot.move(this.index, by);
    } else if (event.key === 'l' || event.key === 'L') {
      this.toggleLogarithm();
    }
  }

  toggleLogarithm() {
    if (this.column.canBeLogarithmic) {
      this.column.isLogarithmic = !this.column.isLogarithmic;
      this.plot.setColumns(this.plot.columns);
    }
  }

  dragName(down) {
    const { plot } = this;
    const start = down.clientX;
    this.name.setPointerCapture(down.pointerId);
    const move = (event) => {
      this.element.style.translate = `${event.clientX - start}px 0`;
    };
    const up = (event) => {
      this.name.removeEventListener('pointermove', move);
      this.element.style.translate = '';
      const gap = plot.x(1) - plot.x(0) || 1;
      const by = Math.round((event.clientX - start) / gap);
      if (by !== 0) {
        plot.move(this.index, by);
      } else if (event.detail === 2 || down.detail === 2) {
        this.toggleLogarithm();
      }
    };
    this.name.addEventListener('pointermove', move);
    this.name.addEventListener('pointerup', up, { once: true });
  }

  // ---- the brush ---------------------------------------------------------------------------------

  // The range of the selection as places [from, to] on the axis, null: none.
  places() {
    const range = this.plot.selection.range(this.column.key);
    return range && range.map((value) => Math.min(Math.max(this.column.place(value), 0), 1));
  }

  follow() {
    const places = this.places();
    this.brush.hidden = !places;
    const text = places
      ? this.plot.selection
          .range(this.column.key)
          .map((value) => this.edgeText(value))
          .join(' to ')
      : 'all';
    this.track.setAttribute('aria-valuetext', text);
    this.track.setAttribute('aria-valuenow', places ? Math.round(50 * (places[0] + places[1])) : 50);
    if (places) {
      this.brush.style.top = `${(1 - places[1]) * 100}%`;
      this.brush.style.height = `${Math.max((places[1] - places[0]) * 100, 0.5)}%`;
    }
  }

  edgeText(value) {
    return this.column.words
      ? this.column.text(Math.min(Math.max(value, 0), this.column.words.length - 1))
      : this.column.textWithUnit(value);
  }

  set(from, to) {
    const low = Math.min(Math.max(Math.min(from, to), 0), 1);
    const high = Math.min(Math.max(Math.max(from, to), 0), 1);
    const whole = low <= 0 && high >= 1;
    // a little beyond the ends, so that rounding leaves no design out
    const edge = (place, end) => this.column.at(place === end ? place + (end ? 1e-9 : -1e-9) : place);
    this.plot.selection.limit(this.column.key, whole ? null : [edge(low, 0), edge(high, 1)]);
  }

  brushKey(event) {
    const [low, high] = this.places() || [0, 1];
    const by = { ArrowUp: STEP, ArrowDown: -STEP, PageUp: 5 * STEP, PageDown: -5 * STEP }[event.key];
    if (by) {
      event.preventDefault();
      if (event.shiftKey) {
        // the upper end alone
        this.set(low, Math.max(high + by, low));
      } else if (low <= 0 && high >= 1) {
        this.set(by > 0 ? by : 0, by > 0 ? 1 : 1 + by);
      } else {
        const room = by > 0 ? Math.min(by, 1 - high) : Math.max(by, -low);
        this.set(low + room, high + room);
      }
    } else if (['Escape', 'Delete', 'Backspace'].includes(event.key)) {
      event.preventDefault();
      this.plot.selection.limit(this.column.key, null);
    }
  }

  dragBrush(down) {
    const box = this.track.getBoundingClientRect();
    if (Math.abs(down.clientX - (box.left + box.width / 2)) > REACH) {
      return;
    }
    down.preventDefault();
    this.track.focus({ preventScroll: true });
    this.track.setPointerCapture(down.pointerId);
    const place = (event) => 1 - (event.clientY - box.top) / box.height;
    const start = place(down);
    const [low, high] = this.places() || [NaN, NaN];
    const edge = EDGE / box.height;
    let to = (at) => this.set(start, at);
    if (Math.abs(start - low) < edge) {
      to = (at) => this.set(at, high);
    } else if (Math.abs(start - high) < edge) {
      to = (at) => this.set(low, at);
    } else if (start > low && start < high) {
      to = (at) => {
        const by = Math.min(Math.max(at - start, -low), 1 - high);
        this.set(low + by, high + by);
      };
    }
    let hasMoved = false;
    const move = (event) => {
      hasMoved = true;
      to(place(event));
    };
    const up = () => {
      this.track.removeEventListener('pointermove', move);
      if (!hasMoved) {
        // a click takes the brush away
        this.plot.selection.limit(this.column.key, null);
      }
    };
    this.track.addEventListener('pointermove', move);
    this.track.addEventListener('pointerup', up, { once: true });
    this.track.addEventListener('pointercancel', up, { once: true });
  }
}
