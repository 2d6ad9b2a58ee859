// One column against another, a mark a design. Dragging a rectangle limits both columns; a click names a
// design; designs of a Pareto front are ringed and joined.

import { addCanvas, eachFrame, fit, followSize, sharpness } from './canvas.js';
import { discOf, dotOf, stamp } from './discs.js';
import { pageColour, pageParts, rowShades, shades } from './paint.js';
import { ticksOf } from './ticks.js';

const LEFT = 64;
const RIGHT = 14;
const TOP = 12;
const BOTTOM = 46;
const MANY = 3000; // designs from which marks have hard edges
const NEAR = 10; // pixels within which a mark is meant

export class Scatter {
  constructor(place, designs, selection, { x, y, colour, onHover, onPick }) {
    Object.assign(this, { place, designs, selection, x, y, colour, onHover, onPick, front: [], hovered: -1 });
    this.points = addCanvas(place);
    this.axes = addCanvas(place);
    this.marks = addCanvas(place);
    this.draw = eachFrame(() => this.paint(), place);
    selection.listen(() => this.draw());
    followSize(place, (width, height) => {
      this.width = width;
      this.height = height;
      this.arrange();
    });
    place.addEventListener('pointerdown', (event) => this.drag(event));
    place.addEventListener('pointermove', (event) => this.hover(event));
    place.addEventListener('pointerleave', () => this.onHover(-1));
  }

  show(columns) {
    Object.assign(this, columns);
    this.arrange();
  }

  // rows of a Pareto front, in the order in which they are joined
  showFront(rows) {
    this.front = rows;
    this.paintMarks();
  }

  arrange() {
    if (!this.width) {
      return;
    }
    this.scale = this.designs.count > MANY ? 1 : sharpness();
    this.spanX = this.width - LEFT - RIGHT;
    this.spanY = this.height - TOP - BOTTOM;
    fit(this.points, this.width, this.height, this.scale);
    fit(this.axes, this.width, this.height, sharpness());
    fit(this.marks, this.width, this.height, sharpness());
    this.pixels = new ImageData(this.points.width, this.points.height);
    this.places = [this.x.places(), this.y.places()];
    this.radius = (this.designs.count > MANY ? 1.6 : this.designs.count > 500 ? 2.4 : 3.6) * this.scale;
    this.base = null;
    this.findSpots();
    this.shades = rowShades(this.designs, this.colour);
    this.paintAxes();
    this.paintMarks();
    this.draw();
  }

  // Where each design is in the pixels: their index, -1 without a value.
  findSpots() {
    const {
      places: [px, py],
      scale,
      points: { width },
    } = this;
    this.spots = new Int32Array(this.designs.count).fill(-1);
    for (let row = 0; row < this.spots.length; row++) {
      if (px[row] === px[row] && py[row] === py[row]) {
        this.spots[row] = Math.round(this.top(py[row]) * scale) * width + Math.round(this.left(px[row]) * scale);
      }
    }
  }

  left(place) {
    return LEFT + (0.02 + 0.96 * place) * this.spanX;
  }

  top(place) {
    return TOP + (0.98 - 0.96 * place) * this.spanY;
  }

  placeX(left) {
    return ((left - LEFT) / this.spanX - 0.02) / 0.96;
  }

  placeY(top) {
    return (0.98 - (top - TOP) / this.spanY) / 0.96;
  }

  paint() {
    if (!this.pixels) {
      return;
    }
    const {
      designs: { count },
      selection,
      pixels,
    } = this;
    if (selection.count < count) {
      this.base ??= this.drawBase();
      pixels.data.set(this.base);
    } else {
      pixels.data.fill(0);
    }
    this.drawRows(pixels, selection.rows());
    this.points.getContext('2d').putImageData(pixels, 0, 0);
    this.paintMarks();
  }

  // All designs, quietly, below those that are selected.
  drawBase() {
    const { width, height } = this.pixels;
    const pixels = new ImageData(width, height);
    const quiet = pageParts('plot-quiet');
    const cells = discOf(this.radius * 0.7);
    for (let row = 0; row < this.designs.count; row++) {
      if (this.spots[row] >= 0) {
        stamp(pixels, cells, this.spots[row] % width, Math.floor(this.spots[row] / width), quiet, 0, 0.55);
      }
    }
    return pixels.data;
  }

  drawRows(pixels, rows) {
    const { spots, shades: shaded } = this;
    const { width } = pixels;
    const colours = shades();
    if (this.designs.count <= MANY) {
      const cells = discOf(this.radius);
      for (const row of rows) {
        if (spots[row] >= 0) {
          stamp(pixels, cells, spots[row] % width, Math.floor(spots[row] / width), colours, 3 * shaded[row], 0.9);
        }
      }
      return;
    }
    const out = new Uint32Array(pixels.data.buffer);
    const steps = dotOf(this.radius, width);
    for (const row of rows) {
      const spot = spots[row];
      if (spot >= 0) {
        const c = 3 * shaded[row];
        const colour = (255 << 24) | (colours[c + 2] << 16) | (colours[c + 1] << 8) | colours[c];
        for (let k = 0; k < steps.length; k++) {
          out[spot + steps[k]] = colour;
        }
      }
    }
  }

  context(canvas) {
    const context = canvas.getContext('2d');
    const scale = sharpness();
    context.setTransform(scale, 0, 0, scale, 0, 0);
    context.clearRect(0, 0, this.width, this.height);
    return context;
  }

  paintAxes() {
    const context = this.context(this.axes);
    context.font = '11px system-ui, "DejaVu Sans", sans-serif';
    context.fillStyle = pageColour('ink');
    context.strokeStyle = pageColour('rule');
    const bottom = TOP + this.spanY;
    context.strokeRect(LEFT + 0.5, TOP + 0.5, this.spanX, this.spanY);
    context.textAlign = 'center';
    context.textBaseline = 'top';
    for (const [value, text] of ticksOf(this.x, Math.max(this.spanX / 90, 2))) {
      const x = this.left(this.x.place(value));
      this.rule(context, x, bottom, x, bottom + 4);
      context.fillText(text.slice(0, 18), x, bottom + 7);
    }
    context.textAlign = 'right';
    context.textBaseline = 'middle';
    for (const [value, text] of ticksOf(this.y, Math.max(this.spanY / 55, 2))) {
      const y = this.top(this.y.place(value));
      this.rule(context, LEFT - 4, y, LEFT, y);
      context.fillText(text.slice(0, 9), LEFT - 7, y);
    }
    context.font = '600 12px system-ui, "DejaVu Sans", sans-serif';
    context.textAlign = 'center';
    context.fillText(this.x.label, LEFT + this.spanX / 2, this.height - 9);
    context.translate(11, TOP + this.spanY / 2);
    context.rotate(-Math.PI / 2);
    context.fillText(this.y.label, 0, 0);
  }

  rule(context, x0, y0, x1, y1) {
    context.beginPath();
    context.moveTo(x0, y0);
    context.lineTo(x1, y1);
    context.stroke();
  }

  // The rectangle of both ranges, the front and the design that is pointed at.
  paintMarks() {
    if (!this.width) {
      return;
    }
    const context = this.context(this.marks);
    const [px, py] = this.places;
    const rangeX = this.selection.range(this.x.key);
    const rangeY = this.selection.range(this.y.key);
    if (rangeX || rangeY) {
      const [x0, x1] = rangeX ? rangeX.map((v) => this.left(this.x.place(v))) : [LEFT, LEFT + this.spanX];
      const [y0, y1] = rangeY ? rangeY.map((v) => this.top(this.y.place(v))) : [TOP + this.spanY, TOP];
      context.strokeStyle = pageColour('accent');
      context.setLineDash([5, 4]);
      context.strokeRect(x0, y1, x1 - x0, y0 - y1);
      context.setLineDash([]);
    }
    context.strokeStyle = pageColour('plot-front');
    context.lineWidth = 1.5;
    context.beginPath();
    this.front.forEach((row) => context.lineTo(this.left(px[row]), this.top(py[row])));
    context.stroke();
    for (const row of [...this.front, ...(this.hovered >= 0 ? [this.hovered] : [])]) {
      context.lineWidth = row === this.hovered ? 3 : 1.5;
      context.strokeStyle = pageColour(row === this.hovered ? 'ink' : 'plot-front');
      context.beginPath();
      context.arc(this.left(px[row]), this.top(py[row]), row === this.hovered ? 7 : 4.5, 0, 2 * Math.PI);
      context.stroke();
    }
  }

  point(row) {
    if (row !== this.hovered) {
      this.hovered = row;
      this.paintMarks();
    }
  }

  nearest(x, y) {
    const [px, py] = this.places;
    let best = -1;
    let least = NEAR * NEAR;
    for (let row = 0; row < this.designs.count; row++) {
      const distance = (this.left(px[row]) - x) ** 2 + (this.top(py[row]) - y) ** 2;
      if (distance < least && this.selection.has(row)) {
        least = distance;
        best = row;
      }
    }
    return best;
  }

  at(event) {
    const box = this.place.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  hover(event) {
    if (event.buttons === 0 && this.places) {
      this.onHover(this.nearest(...this.at(event)), event);
    }
  }

  drag(down) {
    const [x0, y0] = this.at(down);
    let hasMoved = false;
    this.place.setPointerCapture(down.pointerId);
    const ends = (column, a, b) =>
      [Math.min(a, b), Math.max(a, b)].map((place) => column.at(Math.min(Math.max(place, -1e-9), 1 + 1e-9)));
    const move = (event) => {
      const [x1, y1] = this.at(event);
      hasMoved = hasMoved || Math.hypot(x1 - x0, y1 - y0) > 4;
      if (hasMoved) {
        this.selection.limit(this.x.key, ends(this.x, this.placeX(x0), this.placeX(x1)));
        this.selection.limit(this.y.key, ends(this.y, this.placeY(y0), this.placeY(y1)));
      }
    };
    const up = () => {
      this.place.removeEventListener('pointermove', move);
      if (!hasMoved) {
        const row = this.nearest(x0, y0);
        if (row >= 0) {
          this.onPick(row);
        } else {
          this.selection.limit(this.x.key, null);
          this.selection.limit(this.y.key, null);
        }
      }
    };
    this.place.addEventListener('pointermove', move);
    this.place.addEventListener('pointerup', up, { once: true });
  }
}
