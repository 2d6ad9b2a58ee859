// The designs of a study in columns of numbers: what the page filters, draws and lists.

import { number } from '../format.js';

export const STATES = [
  'queued',
  'held',
  'starting',
  'running',
  'cancelling',
  'retry_wait',
  'succeeded',
  'failed',
  'timed_out',
  'cancelled',
];

const LABEL_MOST = 40; // characters of a name that a table has room for

function extent(data) {
  let low = Infinity;
  let high = -Infinity;
  for (const value of data) {
    if (value < low) {
      low = value;
    }
    if (value > high) {
      high = value;
    }
  }
  return low <= high ? [low, high] : [0, 1];
}

// One parameter or metric. Words are kept by their index.
export class Column {
  constructor(description, values, index) {
    this.index = index;
    this.key = description.key;
    this.title = description.title || description.key;
    this.unit = description.unit || '';
    this.isParameter = description.role === 'parameter';
    this.words = description.categorical ? [...(description.words || [])] : null;
    this.data = Float64Array.from(values, (value) => this.numberOf(value));
    [this.low, this.high] = this.words ? [-0.5, Math.max(this.words.length - 0.5, 0.5)] : extent(this.data);
    // what differs by rounding alone does not vary
    this.varies = this.words
      ? new Set(this.data.filter((v) => v === v)).size > 1
      : this.high - this.low > 1e-6 * Math.max(Math.abs(this.low), Math.abs(this.high));
    // a parameter that counts something
    this.isWhole = this.isParameter && !this.words && !this.unit && this.data.every((v) => v !== v || Number.isInteger(v));
    this.canBeLogarithmic = !this.words && this.low > 0;
    this.isLogarithmic = this.canBeLogarithmic && description.logarithmic === true;
  }

  numberOf(value) {
    if (typeof value === 'string' && this.words) {
      const known = this.words.indexOf(value);
      return known >= 0 ? known : this.words.push(value) - 1;
    }
    return typeof value === 'number' ? value : NaN;
  }

  get label() {
    return this.unit ? `${this.title} (${this.unit})` : this.title;
  }

  // A value as people read it, without the unit.
  text(value) {
    if (value !== value) {
      return '–';
    }
    return this.words ? (this.words[Math.round(value)] ?? '–') : number(value);
  }

  textWithUnit(value) {
    const gap = this.unit === '' || this.unit === '°' ? '' : '\u00a0';
    return `${this.text(value)}${value === value ? gap + this.unit : ''}`;
  }

  // 0 at the low end of the column, 1 at the high one.
  place(value) {
    if (this.isLogarithmic) {
      return Math.log(value / this.low) / Math.log(this.high / this.low);
    }
    return this.high > this.low ? (value - this.low) / (this.high - this.low) : 0.5;
  }

  // The value at a place.
  at(place) {
    return this.isLogarithmic ? this.low * (this.high / this.low) ** place : this.low + place * (this.high - this.low);
  }

  // A value that a design may have, with as many digits as people give.
  tidy(value) {
    return this.isWhole ? Math.round(value) : Number(value.toPrecision(4));
  }

  // The places of all values as numbers of 32 bits.
  places() {
    const places = new Float32Array(this.data.length);
    for (let i = 0; i < places.length; i++) {
      places[i] = this.place(this.data[i]);
    }
    return places;
  }
}

export class Designs {
  // document: the answer of /designs?format=columns
  constructor(document) {
    this.count = document.jobs.length;
    this.jobs = document.jobs;
    this.members = document.members ?? document.jobs.map((_, i) => i);
    this.names = document.names;
    this.reasons = document.reasons ?? [];
    this.states = Uint8Array.from(document.states, (state) => Math.max(STATES.indexOf(state), 0));
    // what a design has that stopped on its way is of another load than what the others have
    const counted = (values) => values.map((value, row) => (document.states[row] === 'succeeded' ? value : null));
    this.columns = document.columns.map(
      (column, i) => new Column(column, column.role === 'parameter' ? document.values[i] : counted(document.values[i]), i),
    );
    this.byKey = new Map(this.columns.map((column) => [column.key, column]));
  }

  get parameters() {
    return this.columns.filter(({ isParameter }) => isParameter);
  }

  get metrics() {
    return this.columns.filter(({ isParameter }) => !isParameter);
  }

  state(row) {
    return STATES[this.states[row]];
  }

  name(row) {
    return this.names[row] || `design ${this.members[row]}`;
  }

  // Its name where there is little room: one that only repeats the parameters is a number.
  label(row) {
    const name = this.name(row);
    return name.length <= LABEL_MOST || this.parameters.length === 0 ? name : `design ${this.members[row]}`;
  }
}
