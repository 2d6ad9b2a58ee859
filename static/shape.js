// The view of the deformed body on the page of a job: pressure, colours and the side it is seen from.

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

const PLAY_MS = 3000;
const stillness = window.matchMedia('(prefers-reduced-motion: reduce)');

function withUnit(value, unit) {
  return unit ? `${number(value)}\u00a0${unit}` : number(value);
}

function short(value) {
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

class ShapeView {
  constructor(section, surface, canvas, renderer) {
    this.canvas = canvas;
    this.surface = surface;
    this.section = section;
    this.pressure = surface.pressures.at(-1);
    this.field = surface.fields[0];
    this.frame = 0;
    this.build();
    this.renderer = renderer;
    this.body = new Body(surface);
    this.camera = new Camera(() => this.draw());
    this.camera.attach(this.canvas);
    this.camera.camera.aspect = this.canvas.clientWidth / this.canvas.clientHeight || 4 / 3;
    this.camera.frame(this.body.box());
    this.readAddress();
    this.change();
    new ResizeObserver(() => this.draw()).observe(this.canvas);
    dark.addEventListener('change', () => this.draw());
  }

  build() {
    const { pressures, fields } = this.surface;
    this.slider = make('input', { type: 'range', id: 'shape-pressure', min: 0, max: 1000, step: 1,
      list: 'shape-states', autocomplete: 'off' });
    const [first, last] = [pressures[0], pressures.at(-1)];
    const marks = make('datalist', { id: 'shape-states' }, ...pressures.map((p) =>
      make('option', { value: Math.round(1000 * (p - first) / (last - first || 1)) })));
    this.output = make('output', { for: 'shape-pressure', id: 'shape-value' });
    this.select = make('select', { id: 'shape-field', autocomplete: 'off' }, ...fields.map(({ name, low, high }, i) =>
      make('option', { value: name, disabled: i > 0 && high <= low }, FIELDS[name] || name)));
    this.ghost = make('input', { type: 'checkbox', id: 'shape-ghost', autocomplete: 'off' });
    this.ghost.checked = true;
    const button = (label, act) => {
      const element = make('button', { type: 'button' }, label);
      element.addEventListener('click', act);
      return element;
    };
    this.play = button('Play', () => this.togglePlay());
    this.slider.disabled = last <= first;
    this.play.disabled = last <= first;
    this.section.querySelector('.shape-tools').replaceChildren(
      make('div', { class: 'shape-row' }, make('label', { for: 'shape-pressure' }, 'Pressure'), this.slider, marks,
        this.output, this.play),
      make('div', { class: 'shape-row' }, make('label', { for: 'shape-field' }, 'Colour by'), this.select,
        make('label', { class: 'inline' }, this.ghost, 'Body at rest'),
        make('span', { class: 'push' }, button('Reset view', () => this.camera.reset()),
          button('Save picture', () => this.save()))),
      make('p', { class: 'muted hint', id: 'shape-help' },
        'Drag to turn, or use the arrow keys; + and − zoom, 0 resets.'));
    this.legend = legend('shape-legend');
    const figure = this.section.querySelector('figure');
    figure.replaceChildren(this.canvas, this.legend);
    this.slider.addEventListener('input', () => {
      this.stop();
      this.pressure = first + (last - first) * this.slider.valueAsNumber / 1000;
      this.change();
    });
    this.select.addEventListener('change', () => {
      this.field = fields.find(({ name }) => name === this.select.value);
      this.change();
    });
    this.ghost.addEventListener('change', () => this.draw());
  }

  // ---- state of the view, also in the address -----------------------------------------------

  readAddress() {
    const [pressure, name] = decodeURIComponent(window.location.hash).replace('#shape=', '').split(',');
    const field = this.surface.fields.find((one) => one.name === name);
    if (field && Number.isFinite(Number(pressure))) {
      const [first, last] = [this.surface.pressures[0], this.surface.pressures.at(-1)];
      this.pressure = Math.min(Math.max(Number(pressure), first), last);
      this.field = field;
      this.select.value = name;
    }
  }

  writeAddress() {
    clearTimeout(this.later);
    this.later = setTimeout(() => {
      window.history.replaceState(null, '', `#shape=${short(this.pressure)},${this.field.name}`);
    }, 300);
  }

  change() {
    const [first, last] = [this.surface.pressures[0], this.surface.pressures.at(-1)];
    const text = withUnit(short(this.pressure), 'kPa');
    this.range = this.surface.rangeOf(this.field);
    this.body.set(this.pressure, this.field, this.range);
    this.slider.value = Math.round(1000 * (this.pressure - first) / (last - first || 1));
    this.slider.setAttribute('aria-valuetext', text);
    setText(this.output, text);
    showLegend(this.legend, this.field, this.range);
    const [low, high] = this.range;
    this.canvas.setAttribute('aria-label', `Deformed body at ${text}, coloured by `
      + `${(FIELDS[this.field.name] || this.field.name).toLowerCase()} from ${withUnit(short(low), this.field.unit)} `
      + `to ${withUnit(short(high), this.field.unit)}`);
    if (this.touched) {
      this.writeAddress();
    }
    this.touched = true;
    this.draw();
  }

  // ---- drawing ------------------------------------------------------------------------------

  draw() {
    if (!this.frame && this.body && this.camera) {
      this.frame = requestAnimationFrame(() => {
        this.frame = 0;
        this.drawNow();
        this.canvas.dataset.drawn = Number(this.canvas.dataset.drawn || 0) + 1;
      });
    }
  }

  drawNow() {
    const [width, height] = fitRenderer(this.renderer);
    this.body.ghost.visible = this.ghost.checked;
    if (width > 0 && height > 0) {
      this.body.draw(this.renderer, this.camera.camera, width, height);
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

  // ---- the load as it rises -----------------------------------------------------------------

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
    const { pressures } = this.surface;
    setText(this.play, 'Stop');
    if (stillness.matches) { // state by state, nothing moves in between
      let state = 0;
      this.stepping = setInterval(() => {
        this.pressure = pressures[state++];
        this.change();
        if (state === pressures.length) {
          this.stop();
        }
      }, 700);
      return;
    }
    const start = performance.now();
    const step = (now) => {
      const share = Math.min((now - start) / PLAY_MS, 1);
      this.pressure = pressures[0] + share * (pressures.at(-1) - pressures[0]);
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
    new ShapeView(section, await loadSurface(section.dataset.surface), canvas, renderer);
    section.dataset.ready = 'yes';
  } catch (problem) {
    section.dataset.ready = 'no';
    find('shape').append(make('p', { class: 'muted' }, `This body cannot be turned here: ${problem.message}`));
  }
}
