// Fields for the main dimensions of a job, made from the schema of job documents.

import { make } from './dom.js';
import { placesOf, withValue } from './json_places.js';

const PARTS = ['actuator', 'load', 'material', 'accuracy', 'contact', 'timeout'];

function at(document, pointer) {
  return pointer.split('/').slice(1).reduce((value, key) => value?.[key], document);
}

// Which of several forms of a value the document has: the one whose fixed words fit.
function fits(schema, value) {
  const fixed = Object.entries(schema.properties || {}).filter(([, one]) => 'const' in one);
  if (schema.type === 'object' || schema.properties) {
    return value !== null && typeof value === 'object' && fixed.every(([key, one]) => value[key] === one.const);
  }
  return typeof value !== 'object';
}

class Walk {
  constructor(root) {
    this.root = root;
    this.fields = [];
  }

  resolve(schema, value) {
    let found = schema;
    while (found?.$ref || found?.oneOf) {
      const { $ref, oneOf, ...rest } = found;
      const target = $ref ? $ref.split('/').slice(1).reduce((part, key) => part[key], this.root)
        : oneOf.map((one) => this.resolve(one, value)).find((one) => fits(one, value)) || {};
      found = { ...target, ...Object.fromEntries(Object.entries(rest).filter(([key]) => key !== 'examples' || !target.examples)) };
    }
    return found || {};
  }

  visit(schema, pointer, document, group) {
    const value = at(document, pointer);
    const one = this.resolve(schema, value);
    const isLeaf = one['x-unit'] || one.enum || ['integer', 'number', 'boolean'].includes(one.type);
    if (isLeaf && (value === undefined || typeof value !== 'object')) {
      this.fields.push({ pointer, group, value, schema: one });
    } else if (one.properties && (value !== undefined || pointer === '')) {
      for (const [key, part] of Object.entries(one.properties)) {
        if (pointer !== '' || PARTS.includes(key)) {
          const title = part.title || this.resolve(part, value?.[key]).title || key;
          this.visit(part, `${pointer}/${key}`, document, pointer === '' ? title : group);
        }
      }
    } else if (Array.isArray(value) && one.items) {
      value.forEach((_, i) => this.visit(one.items, `${pointer}/${i}`, document, group));
    }
  }
}

// The fields of a document: [{ pointer, group, value, schema }].
function fieldsOf(schema, document) {
  const kind = Object.values(schema.$defs).find((one) => one.properties?.kind?.const === document.kind);
  const base = document.kind === 'study' && document.base
    ? Object.values(schema.$defs).find((one) => one.properties?.kind?.const === document.base.kind) : null;
  const walk = new Walk(schema);
  if (base) {
    const inner = new Walk(schema);
    inner.visit(base, '', document.base, '');
    walk.fields = inner.fields.map((field) => ({ ...field, pointer: `/base${field.pointer}` }));
  } else if (kind) {
    walk.visit(kind, '', document, '');
  }
  return walk.fields;
}

function titleOf({ pointer, schema }) {
  const inArray = /\/(\d+)\/[^/]+$/.exec(pointer);
  const title = schema.title || pointer.split('/').pop().replaceAll('_', ' ');
  return inArray ? `${title}, ${Number(inArray[1]) + 1}.` : title;
}

function hintOf({ schema }) {
  const parts = [];
  if (schema['x-minimum'] || schema['x-maximum']) {
    parts.push([schema['x-minimum'] && `from ${schema['x-minimum']}`, schema['x-maximum'] && `to ${schema['x-maximum']}`]
      .filter(Boolean).join(' '));
  } else if (typeof schema.minimum === 'number') {
    parts.push(`from ${schema.minimum}${typeof schema.maximum === 'number' ? ` to ${schema.maximum}` : ''}`);
  }
  return parts.join('; ');
}

function control(field, id) {
  const { schema, value } = field;
  const common = { id, 'data-pointer': field.pointer, 'aria-describedby': `${id}-hint`, autocomplete: 'off' };
  if (schema.enum || schema.type === 'boolean') {
    const words = schema.enum || [true, false];
    const select = make('select', common,
      value === undefined ? make('option', { value: '' }, `${schema.default ?? 'default'} (default)`) : null,
      ...words.map((word) => make('option', { value: JSON.stringify(word) }, String(word))));
    select.value = value === undefined ? '' : JSON.stringify(value);
    return select;
  }
  const input = make('input', { ...common, type: 'text', spellcheck: 'false',
    inputmode: schema['x-unit'] ? null : 'numeric', placeholder: schema.default ?? schema.examples?.[0] ?? '' });
  input.value = value === undefined ? '' : String(value);
  return input;
}

// What a person wrote, as a value of the document; undefined for nothing. A bare number gets the unit of
// the field.
function written({ schema, value }, element) {
  const text = element.value.trim();
  if (text === '') {
    return undefined;
  }
  if (element.tagName === 'SELECT') {
    return JSON.parse(text);
  }
  if (schema['x-unit']) {
    const unit = typeof value === 'string' ? value.replace(/^[-+.\deE\s]+/, '') : schema['x-unit'];
    return /^[-+]?[\d.]+(e[-+]?\d+)?$/i.test(text) ? `${text} ${unit || schema['x-unit']}` : text;
  }
  return Number.isFinite(Number(text)) ? Number(text) : text;
}

export class Fields {
  // place: where they go; change(text) is called with the new text of the document.
  constructor(place, schema, change) {
    Object.assign(this, { place, schema, change, text: '', shape: '' });
  }

  // Shows the fields of a document; false when it cannot be read, and the fields stay.
  show(text) {
    let document;
    try {
      document = JSON.parse(text);
      placesOf(text);
    } catch {
      return false;
    }
    this.text = text;
    this.fields = document && typeof document === 'object' ? fieldsOf(this.schema, document) : [];
    const shape = this.fields.map(({ pointer, value }) => pointer + (value === undefined ? '?' : '')).join();
    if (shape === this.shape) {
      this.refresh();
    } else {
      this.shape = shape;
      this.build();
    }
    return true;
  }

  // The same fields with other values; the one that is being written in is left alone.
  refresh() {
    this.fields.forEach(({ value }, i) => {
      const element = this.place.querySelector(`#field-${i}`);
      if (element !== document.activeElement && value !== undefined) {
        element.value = element.tagName === 'SELECT' ? JSON.stringify(value) : String(value);
      }
    });
  }

  row(field, i) {
    const id = `field-${i}`;
    const element = control(field, id);
    element.addEventListener('change', () => this.take(i, element));
    const hint = [field.schema.description, hintOf(field)].filter(Boolean).join(' ');
    return make('div', { class: 'field' },
      make('label', { for: id, title: field.pointer }, titleOf(field)), element,
      make('span', { class: 'hint muted', id: `${id}-hint` }, hint));
  }

  build() {
    const focus = document.activeElement?.dataset?.pointer;
    const groups = new Map();
    this.fields.forEach((field, i) => {
      const group = groups.get(field.group) || { given: [], open: [] };
      (field.value === undefined ? group.open : group.given).push(this.row(field, i));
      groups.set(field.group, group);
    });
    this.place.replaceChildren(...[...groups].map(([title, { given, open }]) =>
      make('fieldset', {}, make('legend', {}, title), ...given, open.length > 0
        ? make('details', {}, make('summary', {}, `${open.length} more that can be given`), ...open) : null)));
    if (groups.size === 0) {
      this.place.replaceChildren(make('p', { class: 'muted' }, 'This kind of job has none; the text has it all.'));
    }
    if (focus) {
      this.place.querySelector(`[data-pointer="${CSS.escape(focus)}"]`)?.focus();
    }
  }

  take(i, element) {
    const field = this.fields[i];
    const value = written(field, element);
    if (value !== undefined && value !== field.value) {
      this.change(withValue(this.text, field.pointer, value));
    }
  }

  // Marks the field of a pointer as wrong, with the reason; null marks none. True when there is one.
  mark(pointer, reason) {
    for (const element of this.place.querySelectorAll('[aria-invalid]')) {
      element.removeAttribute('aria-invalid');
      element.closest('.field').querySelector('.wrong')?.remove();
    }
    const element = pointer === null ? null : this.place.querySelector(`[data-pointer="${CSS.escape(pointer)}"]`);
    if (!element) {
      return false;
    }
    element.setAttribute('aria-invalid', 'true');
    const details = element.closest('details');
    if (details) {
      details.open = true;
    }
    element.after(make('span', { class: 'wrong' }, reason));
    return true;
  }
}
