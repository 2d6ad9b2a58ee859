// The view of the deformed body, or of a grasp, on the page of a job: where it is on its way, colours and
// the side it is seen from.

import { Body, fitRenderer, makeRenderer } from './body.js';
import { Camera } from './camera.js';
import { dark } from './colours.js';
import { find, make, setText } from './dom.js';
import { number } from './format.js';
import { loadSurface } from './surface.js';

export const FIELDS = {
  stretch: 'Largest stretch',
  von_mises: 'Von Mises stress',
  contact_pressure: 'Contact pressure',
};

const stillness = window.matchMedia('(prefers-reduced-motion: reduce)');

export function withUnit(value, unit) {
  return unit ? `${number(value)}\u00a0${unit}` : number(value);
}

export function short(value) {
  return Number(value.toPrecision(3));
}

// Five numbers of a scale, all with the decimals that its steps need.
function ticksOf(low, high) {
  const decimals = Math.min(Math.max(1 - Math.floor(Math.log10((high - low) / 4 || 1)), 0), 6);
  return [0, 0.25, 0.5, 0.75, 1].map((t) => (low + t * (high - low)).toFixed(decimals).replace('-', '−'));
}

export function legend(id) {
  return make('div', { class: 'legend', id }, make('div', { class: 'legend-title' }),
    make('div', { class: 'legend-bar' }), make('div', { class: 'legend-ticks' }));
}

export function showLegend(element, field, [low, high]) {
  const unit = field.unit ? ` (${field.unit})` : '';
  setText(element.querySelector('.legend-title'), `${FIELDS[field.name] || field.name}${unit}`);
  const ticks = ticksOf(low, high);
  if (high < field.high - 1e-6 * Math.abs(field.high)) {
    ticks[4] = `≥\u00a0${ticks[4]}`;
  }
  element.querySelector('.legend-ticks').replaceChildren(...ticks.map((text) => make('span', {}, text)));
}

// A body under a load that rises: what the view shows of a response. Of a grasp that is a Grasp.
class Load {
  constructor(surface) {
    this.surface = surface;
    this.body = new Body(surface);
    this.positions = surface.positions;
    this.fields = surface.fields;
    this.moments = []; // places to jump to: { name, position }
    this.label = 'Pressure';
    this.toggle = 'Body at rest';
    this.playMs = 3000;
  }

  // Where the slider is.
  text(position) {
    return withUnit(short(position), 'kPa');
  }

  // The same for whoever cannot see it.
  sentence(position) {
    return `Deformed body at ${this.text(position)}`;
  }

  // Takes a position, and gives the range of the colours.
  set(position, field) {
    const range = this.surface.rangeOf(field);
    this.body.set(position, field, range);
    return range;
  }

  box() {
    return this.body.box();
  }

  draw(renderer, camera, [width, height], toggled) {
    this.body.ghost.visible = toggled;
    this.body.draw(renderer, camera, width, height);
  }
}

class ShapeView {
  constructor(section, subject, canvas, renderer) {
    this.canvas = canvas;
    this.subject = subject;
    this.section = section;
    this.first = subject.positions[0];
    this.last = subject.positions.at(-1);
    this.position = subject.start ?? this.last;
    this.field = subject.fields[0];
    this.frame = 0;
    this.build();
    this.renderer = renderer;
    this.camera = new Camera(() => this.draw());
    this.camera.attach(this.canvas);
    this.camera.camera.aspect = this.canvas.clientWidth / this.canvas.clientHeight || 4 / 3;
    this.camera.frame(subject.box(), subject.side?.());
    this.readAddress();
    this.change();
    new ResizeObserver(() => this.draw()).observe(this.canvas);
    dark.addEventListener('change', () => this.change());
  }

  build() {
    const { positions, fields, moments, label, toggle } = this.subject;
    this.slider = make('input', { type: 'range', id: 'shape-pressure', min: 0, max: 1000, step: 1,
      list: 'shape-states', autocomplete: 'off' });
    const marks = make('datalist', { id: 'shape-states' }, ...positions.map((p) =>
      make('option', { value: this.share(p) })));
    this.output = make('output', { for: 'shape-pressure', id: 'shape-value' });
    this.select = make('select', { id: 'shape-field', autocomplete: 'off' }, ...fields.map(({ name, low, high }, i) =>
      make('option', { value: name, disabled: i > 0 && high <= low }, FIELDS[name] || name)));
    this.toggled = make('input', { type: 'checkbox', id: 'shape-ghost', autocomplete: 'off' });
    this.toggled.checked = true;
    const button = (label, act) => {
      const element = make('button', { type: 'button' }, label);
      element.addEventListener('click', act);
      return element;
    };
    this.play = button('Play', () => this.togglePlay());
    this.slider.disabled = this.last <= this.first;
    this.play.disabled = this.last <= this.first;
    const jumps = moments.map(({ name, position }) => button(name, () => this.go(position)));
    this.section.querySelector('.shape-tools').replaceChildren(
      make('div', { class: 'shape-row' }, make('label', { for: 'shape-pressure' }, label), this.slider, marks,
        this.output, this.play),
      jumps.length > 0 && make('div', { class: 'shape-row', role: 'group', 'aria-label': 'Moments' }, 'Go to', ...jumps),
      make('div', { class: 'shape-row' }, make('label', { for: 'shape-field' }, 'Colour by'), this.select,
        make('label', { class: 'inline' }, this.toggled, toggle),
        make('span', { class: 'push' }, button('Reset view', () => this.camera.reset()),
          button('Save picture', () => this.save()))),
      make('p', { class: 'muted hint', id: 'shape-help' },
        'Drag to turn, or use the arrow keys; + and − zoom, 0 resets.'));
    this.legend = legend('shape-legend');
    const figure = this.section.querySelector('figure');
    figure.replaceChildren(this.canvas, this.legend);
    this.slider.addEventListener('input', () => {
      this.go(this.first + (this.last - this.first) * this.slider.valueAsNumber / 1000);
    });
    this.select.addEventListener('change', () => {
      this.field = fields.find(({ name }) => name === this.select.value);
      this.change();
    });
    this.toggled.addEventListener('change', () => this.draw());
  }

  // ---- state of the view, also in the address -----------------------------------------------

  // Where the slider stands at a position.
  share(position) {
    return Math.round(1000 * (position - this.first) / (this.last - this.first || 1));
  }

  go(position) {
    this.stop();
    this.position = position;
    this.change();
  }

  readAddress() {
    const [position, name] = decodeURIComponent(window.location.hash).replace('#shape=', '').split(',');
    const field = this.subject.fields.find((one) => one.name === name);
    if (field && Number.isFinite(Number(position))) {
      this.position = Math.min(Math.max(Number(position), this.first), this.last);
      this.field = field;
      this.select.value = name;
    }
  }

  writeAddress() {
    clearTimeout(this.later);
    this.later = setTimeout(() => {
      window.history.replaceState(null, '', `#shape=${short(this.position)},${this.field.name}`);
    }, 300);
  }

  change() {
    const { subject, field } = this;
    const text = subject.text(this.position);
    const range = subject.set(this.position, field);
    this.slider.value = this.share(this.position);
    this.slider.setAttribute('aria-valuetext', text);
    setText(this.output, text);
    showLegend(this.legend, field, range);
    const [low, high] = range.map((value) => withUnit(short(value), field.unit));
    this.canvas.setAttribute('aria-label', `${subject.sentence(this.position)}, coloured by `
      + `${(FIELDS[field.name] || field.name).toLowerCase()} from ${low} to ${high}`);
    if (this.touched) {
      this.writeAddress();
    }
    this.touched = true;
    this.draw();
  }

  // ---- drawing ------------------------------------------------------------------------------

  draw() {
    if (!this.frame && this.camera) {
      this.frame = requestAnimationFrame(() => {
        this.frame = 0;
        this.drawNow();
        this.canvas.dataset.drawn = Number(this.canvas.dataset.drawn || 0) + 1;
      });
    }
  }

  drawNow() {
    const [width, height] = fitRenderer(this.renderer);
    if (width > 0 && height > 0) {
      this.subject.draw(this.renderer, this.camera.camera, [width, height], this.toggled.checked);
    }
  }

  // What was drawn is gone once it is shown: it is drawn anew.
  save() {
    this.drawNow();
    this.canvas.toBlob((blob) => {
      const link = make('a', { href: URL.createObjectURL(blob), download: `${document.title.split(' · ')[0]}.png` });
      link.click();
      setTimeout(() => URL.revokeObjectURL(link.href), 1000);
    });
  }

  // ---- all of it, from the first to the last state ------------------------------------------

  stop() {
    cancelAnimationFrame(this.playing);
    clearInterval(this.stepping);
    this.playing = 0;
    this.stepping = 0;
    setText(this.play, 'Play');
  }

  togglePlay() {
    if (this.playing || this.stepping) {
      this.stop();
      return;
    }
    const { positions, playMs } = this.subject;
    setText(this.play, 'Stop');
    if (stillness.matches) { // state by state, nothing moves in between
      let state = 0;
      this.stepping = setInterval(() => {
        this.position = positions[state++];
        this.change();
        if (state === positions.length) {
          this.stop();
        }
      }, Math.min(700, Math.max(150, playMs / positions.length)));
      return;
    }
    const start = performance.now();
    const step = (now) => {
      const share = Math.min((now - start) / playMs, 1);
      this.position = this.first + share * (this.last - this.first);
      this.change();
      if (share < 1) {
        this.playing = requestAnimationFrame(step);
      } else {
        this.stop();
      }
    };
    this.playing = requestAnimationFrame(step);
  }
}

async function loadSubject({ surface, frames }) {
  if (frames) {
    const { loadGrasp } = await import('./grasp.js');
    return loadGrasp(frames);
  }
  return new Load(await loadSurface(surface));
}

// Turns the picture in a section into a view. Where that cannot be, the picture stays.
export async function setUpShape(section) {
  if (section.dataset.ready) {
    return;
  }
  section.dataset.ready = 'loading';
  try {
    const canvas = make('canvas', { class: 'shape-canvas', role: 'img', id: 'shape-canvas',
      'aria-describedby': 'shape-help' });
    const renderer = makeRenderer(canvas);
    new ShapeView(section, await loadSubject(section.dataset), canvas, renderer);
    section.dataset.ready = 'yes';
  } catch (problem) {
    section.dataset.ready = 'no';
    find('shape').append(make('p', { class: 'muted' }, `This body cannot be turned here: ${problem.message}`));
  }
}
