// The surrogate over two parameters, the others held by sliders: mean or uncertainty as a map, the designs
// near the slice on it, and any place of it solved at a click.

import { find, make } from '../dom.js';
import { number } from '../format.js';
import { chartOf } from './chart.js';
import { lineColour, pageColour, shadeText } from './paint.js';
import { Panel } from './panel.js';
import { analysis } from './source.js';
import { tickText } from './ticks.js';

const RESOLUTION = 33;
const PAUSE_MS = 120; // after the last move of a slider

function axisName({ title, unit }) {
  return unit ? `${title} (${unit})` : title;
}

function mapOption(answer, shows) {
  const { x, y, metric } = answer;
  const values = shows === 'deviation' ? answer.deviation : answer.mean;
  const data = values.flatMap((row, j) => row.map((value, i) => [i, j, value]));
  const all = data.map(([, , value]) => value).filter((value) => value !== null);
  const axis = (one, gap) => ({
    type: 'category',
    data: one.values,
    name: axisName(one),
    nameLocation: 'middle',
    nameGap: gap,
    axisLabel: {
      formatter: (value) => (Number.isNaN(Number(value)) ? value : tickText(Number(Number(value).toPrecision(3)))),
      hideOverlap: true,
      interval: one.values.length > 12 ? 7 : 0,
    },
    axisTick: { alignWithLabel: true, interval: one.values.length > 12 ? 7 : 0 },
    splitLine: { show: false },
  });
  const words = [0, 0.25, 0.5, 0.75, 1].map(shadeText);
  return {
    grid: { left: y.values.some((v) => typeof v === 'string') ? 120 : 64, right: 76, top: 14, bottom: 48 },
    xAxis: axis(x, 28),
    yAxis: axis(y, y.values.some((v) => typeof v === 'string') ? 104 : 46),
    visualMap: {
      type: 'continuous',
      min: Math.min(...all),
      max: Math.max(...all),
      calculable: false,
      right: 0,
      top: 'middle',
      itemWidth: 12,
      itemHeight: 150,
      precision: 3,
      inRange: { color: words },
      textStyle: { color: pageColour('ink'), fontSize: 11 },
      text: [Math.max(...all), Math.min(...all)].map((value) => tickText(Number(value.toPrecision(3)))),
    },
    tooltip: {
      formatter: ({ value: [i, j] }) =>
        `${x.title} ${typeof x.values[i] === 'number' ? number(x.values[i]) : x.values[i]} ${x.unit}\n${y.title} ${
          typeof y.values[j] === 'number' ? number(y.values[j]) : y.values[j]
        } ${y.unit}\n${metric.title} ${number(answer.mean[j][i])} ± ${number(
          Number((1.96 * answer.deviation[j][i]).toPrecision(2)),
        )} ${metric.unit}\nclick to choose it`,
    },
    series: [
      {
        type: 'heatmap',
        data,
        progressive: 0,
        itemStyle: { borderWidth: 0 },
        emphasis: { itemStyle: { borderColor: pageColour('ink'), borderWidth: 1 } },
      },
    ],
  };
}

function lineOption(answer) {
  const { x, metric } = answer;
  const [mean] = answer.mean;
  const [deviation] = answer.deviation;
  const isWord = typeof x.values[0] === 'string';
  const points = (pick) => mean.map((value, i) => (isWord ? pick(value, i) : [x.values[i], pick(value, i)]));
  const band = {
    type: 'line',
    stack: 'band',
    stackStrategy: 'all',
    symbol: 'none',
    lineStyle: { opacity: 0 },
    silent: true,
  };
  return {
    grid: { left: 72, right: 20, top: 14, bottom: 48 },
    xAxis: {
      type: isWord ? 'category' : x.logarithmic ? 'log' : 'value',
      data: isWord ? x.values : undefined,
      min: isWord ? undefined : x.values[0],
      max: isWord ? undefined : x.values.at(-1),
      name: axisName(x),
      nameLocation: 'middle',
      nameGap: 28,
    },
    yAxis: { type: 'value', scale: true, name: axisName(metric), nameLocation: 'middle', nameGap: 44 },
    tooltip: { trigger: 'axis', valueFormatter: number },
    series: [
      { ...band, data: points((value, i) => value - 1.96 * deviation[i]), tooltip: { show: false } },
      {
        ...band,
        data: points((value, i) => 3.92 * deviation[i]),
        areaStyle: { color: '#56b4e9', opacity: 0.3 },
        tooltip: { show: false },
      },
      {
        type: 'line',
        name: metric.title,
        data: points((value) => value),
        symbol: isWord ? 'circle' : 'none',
        itemStyle: { color: lineColour() },
        lineStyle: { color: lineColour(), width: 2.5 },
      },
    ],
  };
}

export class Slice {
  // metric(): key of the metric. onChoose(values): a design on the slice, pointer to value.
  constructor(designs, address, metric, onChoose) {
    Object.assign(this, { designs, address, metric, onChoose });
    this.chart = chartOf(find('slice-plot'));
    this.at = new Map(); // of the sliders: pointer -> value
    for (const [name, value] of address.query) {
      if (name.startsWith('at.') && designs.byKey.has(name.slice(3))) {
        this.at.set(name.slice(3), Number.isNaN(Number(value)) ? value : Number(value));
      }
    }
    this.setUpSelects();
    this.panel = new Panel(
      'slice',
      () => this.ask(),
      (answer) => this.draw(answer),
    );
  }

  setUpSelects() {
    const { parameters } = this.designs;
    const varying = parameters.filter(({ varies }) => varies);
    const [first, second] = varying.length > 0 ? varying : parameters;
    this.x = this.address.get('sx', first?.key);
    this.y = this.address.get('sy', second?.key ?? '');
    const options = () => parameters.map(({ key, title }) => make('option', { value: key }, title));
    find('slice-x').replaceChildren(...options());
    find('slice-y').replaceChildren(make('option', { value: '' }, 'nothing (a curve)'), ...options());
    find('slice-x').value = this.x;
    find('slice-y').value = this.y;
    const follow = () => {
      const { value: x } = find('slice-x');
      const { value: y } = find('slice-y');
      [this.x, this.y] = [x, x === y ? '' : y];
      find('slice-y').value = this.y;
      this.address.set('sx', this.x);
      this.address.set('sy', this.y);
      this.showSliders();
      this.panel.renew();
    };
    find('slice-x').onchange = follow;
    find('slice-y').onchange = follow;
    find('slice-shows').onchange = () => this.answer && this.draw(this.answer);
    this.showSliders();
  }

  middle(column) {
    if (column.words) {
      return column.words[0];
    }
    return column.tidy(Number(column.at(0.5).toPrecision(3)));
  }

  showSliders() {
    const others = this.designs.parameters.filter(({ key }) => key !== this.x && key !== this.y);
    find('slice-sliders').replaceChildren(...others.map((column) => this.slider(column)));
  }

  slider(column) {
    const value = this.at.get(column.key) ?? this.middle(column);
    this.at.set(column.key, value);
    const id = `at-${column.index}`;
    const output = make('output', { for: id }, typeof value === 'number' ? column.textWithUnit(value) : value);
    const control = column.words
      ? make('select', { id }, ...column.words.map((word) => make('option', { selected: word === value }, word)))
      : make('input', { id, type: 'range', min: 0, max: 1, step: 0.01, value: column.place(value) });
    control.addEventListener('input', () => {
      const chosen = column.words ? control.value : column.tidy(column.at(Number(control.value)));
      this.at.set(column.key, chosen);
      output.textContent = column.words ? '' : column.textWithUnit(chosen);
      clearTimeout(this.timer);
      this.timer = setTimeout(() => {
        this.address.set(`at.${column.key}`, String(chosen));
        this.panel.renew();
      }, PAUSE_MS);
    });
    return make(
      'div',
      { class: 'slider' },
      make('label', { for: id }, column.title),
      control,
      column.words ? null : output,
    );
  }

  ask() {
    if (!this.x) {
      return Promise.reject(new Error('The study has no parameter that varies.'));
    }
    const query = { metric: this.metric(), x: this.x, y: this.y, resolution: RESOLUTION };
    for (const [key, value] of this.at) {
      if (key !== this.x && key !== this.y) {
        query[`at.${key}`] = value;
      }
    }
    return analysis('slice', query);
  }

  async draw(answer) {
    this.answer = answer;
    const isMap = answer.y !== null;
    const shows = find('slice-shows').value;
    const text = `${answer.metric.title} expected over ${answer.x.title}${isMap ? ` and ${answer.y.title}` : ''}`;
    await this.chart.show(() => (isMap ? mapOption(answer, shows) : lineOption(answer)), text);
    this.chart.onClick = (event) => this.choose(event);
  }

  // The design at a place of the map.
  choose({ seriesType, value }) {
    const { x, y, at, mean } = this.answer;
    if (seriesType === 'heatmap') {
      const [i, j] = value;
      const tidy = (key, one) => (typeof one === 'number' ? this.designs.byKey.get(key).tidy(one) : one);
      this.onChoose({ ...at, [x.key]: tidy(x.key, x.values[i]), [y.key]: tidy(y.key, y.values[j]) }, mean[j][i], this.answer.metric);
    }
  }
}
