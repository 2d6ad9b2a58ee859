// Deformed bodies side by side, seen by one camera and coloured by one scale. One canvas below all of them
// draws them: browsers allow few with WebGL.

import { Body, fitRenderer, makeRenderer } from './body.js';
import { Camera } from './camera.js';
import { dark } from './colours.js';
import { make, setText } from './dom.js';
import { number } from './format.js';
import { FIELDS, legend, showLegend } from './shape.js';
import { loadSurface } from './surface.js';

async function load(figure) {
  try {
    return { figure, surface: await loadSurface(figure.dataset.surface) };
  } catch {
    return null; // the picture stays
  }
}

// The range of a field over all bodies.
function rangeOf(bodies, name) {
  const ranges = bodies.map(({ surface }) => surface.rangeOf(surface.fields.find((field) => field.name === name)));
  return [Math.min(...ranges.map(([low]) => low)), Math.max(...ranges.map(([, high]) => high))];
}

class Bodies {
  constructor(section, loaded, renderer) {
    this.frame = 0;
    this.renderer = renderer;
    this.canvas = renderer.domElement;
    renderer.setScissorTest(true);
    this.camera = new Camera(() => this.draw());
    this.bodies = loaded.map(({ figure, surface }) => {
      const view = make('div', { class: 'shape-canvas', role: 'img' });
      figure.querySelector('picture').replaceWith(view);
      this.camera.attach(view);
      return { figure, surface, view, body: new Body(surface) };
    });
    section.querySelector('.small-plots').append(this.canvas);
    new ResizeObserver(() => this.draw()).observe(this.canvas);
    const box = this.bodies[0].body.box();
    this.bodies.slice(1).forEach(({ body }) => box.union(body.box()));
    this.camera.camera.aspect = 1.25;
    this.camera.frame(box);
    this.build(section);
    this.change();
    dark.addEventListener('change', () => this.draw());
  }

  build(section) {
    const { fields } = this.bodies[0].surface;
    this.select = make('select', { id: 'bodies-field', autocomplete: 'off' }, ...fields.map(({ name }) =>
      make('option', { value: name }, FIELDS[name] || name)));
    this.slider = make('input', { type: 'range', id: 'bodies-load', min: 0, max: 100, value: 100, autocomplete: 'off' });
    this.output = make('output', { for: 'bodies-load' });
    this.legend = legend('bodies-legend');
    section.querySelector('.bodies-tools').replaceChildren(
      make('div', { class: 'shape-row' },
        make('label', { for: 'bodies-load' }, 'Load'), this.slider, this.output,
        make('label', { for: 'bodies-field' }, 'Colour by'), this.select), this.legend);
    this.slider.addEventListener('input', () => this.change());
    this.select.addEventListener('change', () => this.change());
  }

  // All bodies at the same share of their own load.
  change() {
    const range = rangeOf(this.bodies, this.select.value);
    const share = this.slider.valueAsNumber / 100;
    setText(this.output, `${this.slider.value}\u00a0% of each`);
    this.bodies.forEach(({ figure, surface, view, body }) => {
      const field = surface.fields.find(({ name }) => name === this.select.value);
      const [first, last] = [surface.positions[0], surface.positions.at(-1)];
      const pressure = first + share * (last - first);
      body.set(pressure, field, range);
      const text = `${number(Number(pressure.toPrecision(3)))}\u00a0kPa`;
      setText(figure.querySelector('.at'), `at ${text}`);
      view.setAttribute('aria-label', `${figure.querySelector('a').textContent} at ${text}, coloured by `
        + `${(FIELDS[field.name] || field.name).toLowerCase()}; the arrow keys turn all bodies`);
    });
    showLegend(this.legend, { ...this.bodies[0].surface.fields.find(({ name }) => name === this.select.value),
      high: range[1] }, range);
    this.draw();
  }

  draw() {
    if (!this.frame && this.bodies) {
      this.frame = requestAnimationFrame(() => {
        this.frame = 0;
        this.drawNow();
        this.canvas.dataset.drawn = Number(this.canvas.dataset.drawn || 0) + 1;
      });
    }
  }

  drawNow() {
    const [, height] = fitRenderer(this.renderer);
    const place = this.canvas.getBoundingClientRect();
    this.renderer.setScissor(0, 0, place.width, place.height);
    this.renderer.clear();
    for (const { body, view } of this.bodies) {
      const box = view.getBoundingClientRect();
      const at = [box.left - place.left, height - (box.bottom - place.top), box.width, box.height];
      this.renderer.setViewport(...at);
      this.renderer.setScissor(...at);
      body.draw(this.renderer, this.camera.camera, box.width, box.height);
    }
  }
}

// Turns the pictures of a section into bodies that are turned together.
export async function linkBodies(section) {
  let renderer;
  try {
    renderer = makeRenderer(make('canvas', { class: 'bodies-canvas', 'aria-hidden': 'true' }));
  } catch {
    return; // without WebGL the pictures stay
  }
  const loaded = (await Promise.all([...section.querySelectorAll('[data-surface]')].map(load))).filter(Boolean);
  if (loaded.length > 0) {
    new Bodies(section, loaded, renderer);
  }
}
