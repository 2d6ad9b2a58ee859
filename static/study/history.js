// An optimisation step by step: each evaluation, and the best one so far.

import { find } from '../dom.js';
import { number } from '../format.js';
import { chartOf } from './chart.js';
import { lineColour, pageColour, SERIES } from './paint.js';

export class History {
  constructor() {
    this.chart = chartOf(find('history-plot'));
  }

  // Whether less is better of the metric decides what is best so far.
  show(designs, column, wantsMost) {
    const values = [...column.data];
    let best = NaN;
    const bests = values.map((value) => {
      if (value === value && !(wantsMost ? best >= value : best <= value)) {
        best = value;
      }
      return best;
    });
    const points = (list) => list.map((value, i) => [i + 1, value === value ? value : null]);
    return this.chart.show(
      () => ({
        grid: { left: 76, right: 20, top: 34, bottom: 48 },
        legend: { top: 0, left: 0, textStyle: { color: pageColour('ink') } },
        xAxis: {
          type: 'value',
          min: 1,
          max: Math.max(values.length, 2),
          minInterval: 1,
          name: 'evaluation',
          nameLocation: 'middle',
          nameGap: 28,
        },
        yAxis: { type: 'value', scale: true, name: column.label, nameLocation: 'middle', nameGap: 54 },
        tooltip: { trigger: 'axis', valueFormatter: number },
        series: [
          {
            type: 'scatter',
            name: 'each evaluation',
            data: points(values),
            symbolSize: 6,
            itemStyle: { color: SERIES[4] },
          },
          {
            type: 'line',
            name: 'best so far',
            data: points(bests),
            step: 'end',
            symbol: 'none',
            itemStyle: { color: lineColour() },
            lineStyle: { color: lineColour(), width: 2.5 },
          },
        ],
      }),
      `${column.title} of ${values.length} evaluations; best ${number(best)}`,
    );
  }
}
