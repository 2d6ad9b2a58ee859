// How far the surrogate can be trusted: every design predicted without itself.

import { find } from '../dom.js';
import { number } from '../format.js';
import { chartOf } from './chart.js';
import { lineColour, pageColour, SERIES } from './paint.js';
import { Panel } from './panel.js';
import { analysis } from './source.js';

function option({ metric, left_out: { known, predicted, deviation, jobs } }) {
  const name = metric.unit ? `${metric.title} (${metric.unit})` : metric.title;
  const all = [...known, ...predicted].filter((value) => value !== null);
  const ends = [Math.min(...all), Math.max(...all)];
  const data = known.map((value, i) => [value, predicted[i], 1.96 * deviation[i], jobs[i]]);
  return {
    grid: { left: 68, right: 20, top: 14, bottom: 48 },
    xAxis: { type: 'value', scale: true, name: `${name}, solved`, nameLocation: 'middle', nameGap: 28 },
    yAxis: { type: 'value', scale: true, name: 'predicted without it', nameLocation: 'middle', nameGap: 46 },
    tooltip: {
      formatter: ({ value: [x, y, half, job] }) =>
        `job ${job}\nsolved ${number(x)}\npredicted ${number(y)} ± ${number(half)}`,
    },
    series: [
      {
        type: 'line',
        data: [
          [ends[0], ends[0]],
          [ends[1], ends[1]],
        ],
        symbol: 'none',
        silent: true,
        lineStyle: { color: pageColour('muted'), type: 'dashed', width: 1 },
      },
      {
        type: 'custom',
        silent: true,
        data,
        encode: { x: 0, y: 1 },
        renderItem: (params, api) => {
          const [x, top] = api.coord([api.value(0), api.value(1) + api.value(2)]);
          const [, bottom] = api.coord([api.value(0), api.value(1) - api.value(2)]);
          return {
            type: 'line',
            shape: { x1: x, y1: top, x2: x, y2: bottom },
            style: { stroke: SERIES[4], opacity: 0.5 },
          };
        },
      },
      { type: 'scatter', data, symbolSize: data.length > 200 ? 4 : 6, itemStyle: { color: lineColour() } },
    ],
  };
}

export function setUpQuality(metric) {
  const chart = chartOf(find('quality-plot'));
  return new Panel(
    'quality',
    () => analysis('surrogate', { metric: metric() }),
    async (answer) => {
      const { r2, within_95: within, points, complete } = answer.surrogate;
      find('quality-text').textContent =
        `R² ${r2.toFixed(3)} cross-validated · ${Math.round(100 * within)} % of the designs within their 95 % interval · made of ${
          points === complete ? points : `${points} of ${complete}`
        } designs`;
      await chart.show(() => option(answer), `Predicted against solved ${answer.metric.title}; R² ${r2.toFixed(3)}`);
    },
  );
}
