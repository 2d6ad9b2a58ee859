// Which parameters decide a metric, and how.

import { find } from '../dom.js';
import { number } from '../format.js';
import { chartOf } from './chart.js';
import { lineColour, pageColour, SERIES } from './paint.js';
import { Panel } from './panel.js';
import { analysis } from './source.js';
import { tickText } from './ticks.js';

function percent(share) {
  return `${Math.round(100 * Math.max(share.value, 0))} %`;
}

// A line from the low to the high end of an interval, over the bar of the same place.
function interval(list, pick, shift, colour) {
  return {
    type: 'custom',
    silent: true,
    z: 5,
    data: list.map((one, i) => [i, Math.max(pick(one).low, 0), pick(one).high]),
    renderItem: (params, api) => {
      const [from, y] = api.coord([api.value(1), api.value(0)]);
      const [to] = api.coord([api.value(2), api.value(0)]);
      const at = y + shift * api.size([0, 1])[1];
      return { type: 'line', shape: { x1: from, y1: at, x2: to, y2: at }, style: { stroke: colour, lineWidth: 1.5 } };
    },
    encode: { x: [1, 2], y: 0 },
  };
}

function importanceOption({ parameters }) {
  const list = [...parameters].reverse();
  const bar = (name, pick, colour) => ({
    name,
    type: 'bar',
    barGap: '10%',
    barCategoryGap: '35%',
    itemStyle: { color: colour },
    data: list.map((one) => Math.max(pick(one).value, 0)),
  });
  const ink = pageColour('ink');
  return {
    grid: { left: 140, right: 24, top: 34, bottom: 46 },
    legend: { top: 0, left: 0, itemWidth: 14, textStyle: { color: ink }, data: ['with interactions', 'alone'] },
    xAxis: {
      type: 'value',
      min: 0,
      name: 'share of the variance',
      nameLocation: 'middle',
      nameGap: 26,
      axisLabel: { formatter: (value) => `${Math.round(100 * value)} %` },
    },
    yAxis: {
      type: 'category',
      data: list.map(({ title }) => title),
      axisTick: { show: false },
      axisLabel: { width: 126, overflow: 'truncate' },
    },
    tooltip: {
      trigger: 'axis',
      axisPointer: { type: 'none' },
      valueFormatter: (value) => `${(100 * value).toFixed(1)} %`,
    },
    series: [
      bar('alone', ({ first }) => first, SERIES[4]),
      bar('with interactions', ({ total }) => total, SERIES[0]),
      interval(list, ({ first }) => first, -0.17, ink),
      interval(list, ({ total }) => total, 0.17, ink),
    ],
  };
}

const LEFT = 48; // pixels for the figures of the metric

// One small chart a parameter in one grid, all to the same scale.
function effectsOption({ metric, main }, shown, place) {
  const { length } = shown;
  const across = place.clientWidth < 560 ? 1 : length <= 3 ? Math.max(length, 1) : length === 4 ? 4 : 3;
  const down = Math.ceil(length / across);
  const width = (place.clientWidth - LEFT) / across;
  const height = place.clientHeight / down;
  const all = main.flatMap(({ low, high }) => [...low, ...high]).filter((value) => value !== null);
  const [least, most] = [Math.min(...all), Math.max(...all)];
  const option = { grid: [], xAxis: [], yAxis: [], series: [], tooltip: { trigger: 'axis', valueFormatter: number } };
  shown.forEach((one, i) => {
    const isWord = typeof one.at[0] === 'string';
    const left = LEFT + (i % across) * width;
    const top = Math.floor(i / across) * height;
    const points = (values) => (isWord ? values : one.at.map((at, k) => [at, values[k]]));
    const axes = { xAxisIndex: i, yAxisIndex: i };
    option.grid.push({ left, top: top + 10, width: width - 30, height: height - 60 });
    option.xAxis.push({
      gridIndex: i,
      type: isWord ? 'category' : 'value',
      data: isWord ? one.at : undefined,
      min: isWord ? undefined : one.at[0],
      max: isWord ? undefined : one.at.at(-1),
      name: one.unit ? `${one.title} (${one.unit})` : one.title,
      nameLocation: 'middle',
      nameGap: 24,
      nameTextStyle: { fontSize: 11 },
      splitLine: { show: false },
      splitNumber: 3,
      axisLabel: { hideOverlap: true },
    });
    option.yAxis.push({
      gridIndex: i,
      type: 'value',
      min: least,
      max: most,
      splitNumber: 3,
      axisLabel: { show: i % across === 0, formatter: (value) => tickText(Number(value.toPrecision(3))) },
    });
    option.series.push(
      {
        ...axes,
        type: 'line',
        stack: `band ${i}`,
        stackStrategy: 'all',
        data: points(one.low),
        lineStyle: { opacity: 0 },
        symbol: 'none',
        silent: true,
        tooltip: { show: false },
      },
      {
        ...axes,
        type: 'line',
        stack: `band ${i}`,
        stackStrategy: 'all',
        data: points(one.high.map((high, k) => high - one.low[k])),
        lineStyle: { opacity: 0 },
        symbol: 'none',
        silent: true,
        areaStyle: { color: SERIES[4], opacity: 0.3 },
        tooltip: { show: false },
      },
      {
        ...axes,
        type: 'line',
        name: metric.title,
        data: points(one.mean),
        symbol: isWord ? 'circle' : 'none',
        symbolSize: 7,
        itemStyle: { color: lineColour() },
        lineStyle: { color: lineColour(), width: 2.5, type: isWord ? 'dotted' : 'solid' },
      },
    );
  });
  return option;
}

// metric(): the key of the metric that the page is about. onShare(text, r2): what decides it most, and how
// good the surrogate is that says so.
export function setUpImportance(metric, onShare) {
  const bars = chartOf(find('importance-plot'));
  const importance = new Panel(
    'importance',
    () => analysis('importance', { metric: metric() }),
    async (answer) => {
      const [first] = answer.parameters;
      if (first) {
        onShare(`${first.title}: ${percent(first.total)}`, answer.surrogate.r2);
      }
      const text = answer.parameters.map((one) => `${one.title} ${percent(one.total)}`).join(', ');
      await bars.show(() => importanceOption(answer), `Shares of the variance of ${answer.metric.title}: ${text}`);
    },
  );
  importance.start(); // its answer is at the top of the page
  const lines = chartOf(find('effects-plot'));
  const effects = new Panel(
    'effects',
    () => analysis('effects', { metric: metric() }),
    async (answer) => {
      const size = ({ mean }) => Math.max(...mean) - Math.min(...mean);
      const shown = [...answer.main].sort((a, b) => size(b) - size(a)).slice(0, 6);
      const pairs = answer.pairs.filter(({ share }) => share.low > 0.005).slice(0, 3);
      const titles = new Map(answer.main.map(({ key, title }) => [key, title]));
      find('pairs').textContent =
        pairs.length === 0
          ? 'No two parameters interact noticeably.'
          : `Interactions: ${pairs.map(({ keys, share }) => `${keys.map((key) => titles.get(key)).join(' × ')} ${percent(share)}`).join(' · ')}`;
      await lines.show(
        () => effectsOption(answer, shown, find('effects-plot')),
        `${answer.metric.title} against each parameter: ${shown
          .map((one) => `${one.title} changes it by ${number(size(one))}`)
          .join(', ')}`,
      );
    },
  );
  return [importance, effects];
}
