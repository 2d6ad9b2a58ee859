// Parallel coordinates: an axis a column, a line a design. Lines are drawn as a density, brushes are
// elements that the keyboard reaches, and a range of an axis is one of the selection.

import { addCanvas, eachFrame, fit, followSize, sharpness } from './canvas.js';
import { Density } from './density.js';
import { pageColour, pageParts, rowShades, shadeText, shades } from './paint.js';
import { AxisHead } from './axis.js';
import { ticksOf } from './ticks.js';

const TOP = 62; // heads of the axes
const BOTTOM = 14;
const SIDE = 60;
const FEW = 400; // lines up to which each is drawn by itself
const MANY = 1500; // lines from which one pixel of the page is sharp enough

export class Parallel {
  // place: an element of a fixed size. columns: of the axes. onChange: another order or scale.
  constructor(place, designs, selection, { columns, colour, onChange, onHover }) {
    Object.assign(this, { place, designs, selection, columns, colour, onChange, onHover });
    this.back = addCanvas(place);
    this.front = addCanvas(place);
    this.marks = addCanvas(place);
    this.axisLayer = addCanvas(place);
    this.heads = [];
    this.draw = eachFrame(() => this.paint(), place);
    this.isDue = new Uint8Array(designs.count); // rows whose lines are to be added or taken out
    this.due = [];
    this.hovered = -1;
    selection.listen((changed) => this.follow(changed));
    followSize(place, (width, height) => this.resize(width, height));
    place.addEventListener('pointermove', (event) => this.hover(event));
    place.addEventListener('pointerleave', () => this.show(-1));
  }

  resize(width, height) {
    this.width = width;
    this.height = height;
    this.arrange();
  }

  setColumns(columns) {
    this.columns = columns;
    this.arrange();
    this.onChange();
  }

  // Everything anew: axes, lines, colours.
  arrange() {
    if (!this.width) {
      return;
    }
    const scale = this.designs.count > MANY ? 1 : sharpness();
    this.scale = scale;
    this.inner = this.height - TOP - BOTTOM;
    for (const canvas of [this.back, this.front]) {
      fit(canvas, this.width, this.inner, scale);
      canvas.style.top = `${TOP}px`;
      canvas.style.height = `${this.inner}px`;
    }
    for (const canvas of [this.marks, this.axisLayer]) {
      fit(canvas, this.width, this.height, sharpness());
    }
    this.stops = this.columns.map((_, axis) => Math.round(this.x(axis) * scale));
    this.gaps = this.stops
      .slice(1)
      .map((stop, gap) => new Density(stop - this.stops[gap], this.front.height, this.designs.count <= MANY));
    this.hasBack = false;
    this.places = this.columns.map((column) => column.places());
    this.shades = rowShades(this.designs, this.colour);
    this.isWhole = false;
    this.arrangeHeads();
    this.paintAxes();
    this.draw();
  }

  recolour(colour) {
    this.colour = colour;
    this.arrange();
  }

  x(axis) {
    const gaps = Math.max(this.columns.length - 1, 1);
    return SIDE + (axis / gaps) * (this.width - 2 * SIDE);
  }

  y(place) {
    return TOP + (1 - place) * this.inner;
  }

  arrangeHeads() {
    const focused = this.heads.find((head) => head.element.contains(document.activeElement));
    this.heads.forEach((head) => head.remove());
    this.heads = this.columns.map((column, i) => new AxisHead(this, column, i));
    this.heads.find((head) => head.column === focused?.column)?.focus();
  }

  // Moves an axis by so many places.
  move(axis, by) {
    const to = Math.min(Math.max(axis + by, 0), this.columns.length - 1);
    const columns = [...this.columns];
    columns.splice(to, 0, ...columns.splice(axis, 1));
    this.setColumns(columns);
  }

  // ---- lines -----------------------------------------------------------------------------------

  // Adds rows to a gap, or takes out those that are not selected any more. Gap by gap, since all rows of
  // one gap go to the same piece of memory.
  addLines(gap, density, rows, signOf) {
    const from = this.places[gap];
    const to = this.places[gap + 1];
    const tall = density.height - 2;
    for (const row of rows) {
      const a = from[row];
      const b = to[row];
      if (a === a && b === b) {
        density.line((1 - a) * tall, (1 - b) * tall, this.shades[row], signOf(row));
      }
    }
  }

  follow(changed) {
    if (2 * changed.length > this.designs.count) {
      this.isWhole = false;
    }
    if (this.isWhole) {
      for (const row of changed) {
        // one that comes and goes before the picture is not drawn at all
        this.isDue[row] ^= 1;
        this.due.push(row);
      }
    }
    this.heads.forEach((head) => head.follow());
    this.draw();
  }

  drawChosen() {
    const { selection } = this;
    if (this.isWhole) {
      const rows = this.due.filter((row) => {
        const isDue = this.isDue[row] === 1;
        this.isDue[row] = 0;
        return isDue;
      });
      const sign = (row) => (selection.has(row) ? 1 : -1);
      this.gaps.forEach((density, gap) => this.addLines(gap, density, rows, sign));
    } else {
      const rows = selection.rows();
      this.gaps.forEach((density, gap) => {
        density.clear();
        this.addLines(gap, density, rows, () => 1);
      });
      this.isDue.fill(0);
      this.isWhole = true;
    }
    this.due.length = 0;
  }

  // Lines of their own, those without the value that gives the colour quietly.
  paintFew() {
    const { selection, designs, colour } = this;
    const context = this.front.getContext('2d');
    const tall = (this.front.height - 2) / this.scale;
    context.setTransform(this.scale, 0, 0, this.scale, 0, 0);
    context.clearRect(0, 0, this.width, this.inner);
    context.lineWidth = 1.4;
    context.lineJoin = 'round';
    for (const isSelected of [false, true]) {
      for (let row = 0; row < designs.count; row++) {
        if (selection.has(row) === isSelected) {
          const hasColour = isSelected && !(colour && Number.isNaN(colour.data[row]));
          context.strokeStyle = hasColour ? shadeText(this.shades[row] / 255) : pageColour('plot-quiet');
          this.stroke(context, row, (place) => 1 + (1 - place) * tall);
        }
      }
    }
    this.back.style.opacity = '0';
  }

  // The line of a design; it has a gap where a value is missing.
  stroke(context, row, y) {
    let isOn = false;
    context.beginPath();
    this.places.forEach((places, axis) => {
      const place = places[row];
      if (place !== place) {
        isOn = false;
      } else if (isOn) {
        context.lineTo(this.x(axis), y(place));
      } else {
        context.moveTo(this.x(axis), y(place));
        isOn = true;
      }
    });
    context.stroke();
  }

  paint() {
    const { designs, selection } = this;
    if (!this.gaps) {
      return;
    }
    if (designs.count <= FEW) {
      this.paintFew();
      return;
    }
    this.drawChosen();
    const tone = Math.max(Math.round(selection.count / 350) / 2, 0.35);
    const context = this.front.getContext('2d');
    this.gaps.forEach((density, gap) => context.putImageData(density.paint(shades(), tone), this.stops[gap], 0));
    const isSome = selection.count < designs.count;
    if (isSome && !this.hasBack) {
      this.hasBack = true;
      this.drawBack();
    }
    this.back.style.opacity = isSome ? '1' : '0';
  }

  // All designs, quietly, behind those that are selected.
  drawBack() {
    const grey = pageParts('plot-quiet');
    const colours = Uint8Array.from({ length: 3 * 256 }, (_, i) => grey[i % 3]);
    const rows = Uint32Array.from({ length: this.designs.count }, (_, i) => i);
    const context = this.back.getContext('2d');
    const tone = Math.max(this.designs.count / 250, 1);
    this.gaps.forEach(({ width, height, isSoft }, gap) => {
      const density = new Density(width, height, isSoft);
      this.addLines(gap, density, rows, () => 1);
      context.putImageData(density.paint(colours, tone), this.stops[gap], 0);
    });
  }

  // ---- axes ------------------------------------------------------------------------------------

  paintAxes() {
    const context = this.axisLayer.getContext('2d');
    const scale = sharpness();
    context.setTransform(scale, 0, 0, scale, 0, 0);
    context.clearRect(0, 0, this.width, this.height);
    context.font = '11px system-ui, "DejaVu Sans", sans-serif';
    context.textBaseline = 'middle';
    this.columns.forEach((column, axis) => this.paintAxis(context, column, axis));
  }

  paintAxis(context, column, axis) {
    const x = Math.round(this.x(axis)) + 0.5;
    const isLast = axis === this.columns.length - 1;
    context.strokeStyle = pageColour('muted');
    context.beginPath();
    context.moveTo(x, this.y(1));
    context.lineTo(x, this.y(0));
    context.stroke();
    context.textAlign = isLast ? 'left' : 'right';
    for (const [value, text] of ticksOf(column, Math.max(this.inner / 55, 3))) {
      const y = this.y(column.place(value));
      const at = isLast ? x + 7 : x - 7;
      context.lineWidth = 1;
      context.beginPath();
      context.moveTo(x, y);
      context.lineTo(isLast ? x + 4 : x - 4, y);
      context.stroke();
      const shown = text.length > 14 ? `${text.slice(0, 13)}…` : text;
      context.lineWidth = 4; // a rim, so that lines do not run through the figures
      context.strokeStyle = pageColour('card');
      context.strokeText(shown, at, y);
      context.fillStyle = pageColour('ink');
      context.fillText(shown, at, y);
      context.strokeStyle = pageColour('muted');
      context.lineWidth = 1;
    }
  }

  // ---- one design ------------------------------------------------------------------------------

  // The selected design whose line passes nearest to a point, or -1.
  nearest(x, y) {
    let axis = 0;
    while (axis + 2 < this.columns.length && this.x(axis + 1) < x) {
      axis++;
    }
    const share = (x - this.x(axis)) / (this.x(axis + 1) - this.x(axis));
    const wanted = 1 - (y - TOP) / this.inner;
    const from = this.places[axis];
    const to = this.places[axis + 1];
    let best = -1;
    let least = 8 / this.inner;
    if (!to || share < 0 || share > 1) {
      return -1;
    }
    for (let row = 0; row < this.designs.count; row++) {
      const distance = Math.abs(from[row] + share * (to[row] - from[row]) - wanted);
      if (distance < least && this.selection.has(row)) {
        least = distance;
        best = row;
      }
    }
    return best;
  }

  hover(event) {
    if (event.buttons !== 0 || !this.places) {
      return;
    }
    const box = this.place.getBoundingClientRect();
    this.onHover(this.nearest(event.clientX - box.left, event.clientY - box.top), event);
  }

  // Shows one design over the others; -1: none.
  show(row) {
    if (row === this.hovered) {
      return;
    }
    this.hovered = row;
    const context = this.marks.getContext('2d');
    const scale = sharpness();
    context.setTransform(scale, 0, 0, scale, 0, 0);
    context.clearRect(0, 0, this.width, this.height);
    if (row < 0) {
      return;
    }
    for (const [width, colour] of [
      [5, 'card'],
      [2.5, 'ink'],
    ]) {
      context.lineWidth = width;
      context.strokeStyle = pageColour(colour);
      this.stroke(context, row, (place) => this.y(place));
    }
  }
}

// What the axes show together, for people who do not see them.
export function axesText(designs, columns) {
  return `${designs.count} designs on ${columns.length} axes: ${columns.map(({ label }) => label).join(', ')}`;
}
