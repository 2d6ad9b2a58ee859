// Curves of several jobs in one chart.

import { dark, pageColour, seriesColour } from './colours.js';
import { number } from './format.js';
import { init } from './vendor/echarts.js';

const SYMBOLS = ['circle', 'rect', 'triangle', 'diamond', 'roundRect', 'pin', 'arrow'];
const stillness = window.matchMedia('(prefers-reduced-motion: reduce)');

function axis(name, extra) {
  return {
    type: 'value', name, nameLocation: 'middle', scale: true,
    nameTextStyle: { color: pageColour('ink'), fontSize: 14 },
    axisLine: { lineStyle: { color: pageColour('muted') } },
    axisLabel: { color: pageColour('muted'), fontSize: 13, formatter: (value) => number(value) },
    splitLine: { lineStyle: { color: pageColour('rule') } },
    ...extra,
  };
}

function options({ x, y, series, phone }) {
  return {
    animation: !stillness.matches,
    animationDuration: 300,
    textStyle: { fontFamily: getComputedStyle(document.body).fontFamily },
    aria: { enabled: true, label: { enabled: false } }, // the page has a label of its own
    grid: { left: 64, right: 20, top: 16, bottom: 92, containLabel: false },
    legend: {
      bottom: 0, type: 'scroll', formatter: (name) => (phone && name.length > 22 ? `${name.slice(0, 21)}…` : name),
      textStyle: { color: pageColour('ink'), fontSize: 13 }, pageTextStyle: { color: pageColour('muted') },
    },
    tooltip: {
      trigger: 'item', renderMode: 'richText', backgroundColor: pageColour('card'), borderColor: pageColour('rule'),
      textStyle: { color: pageColour('ink'), fontSize: 13 },
      formatter: ({ seriesName, value }) => `${seriesName}\n${x}: ${number(value[0])}\n${y}: ${number(value[1])}`,
    },
    xAxis: axis(x, { nameGap: 30 }),
    yAxis: axis(y, { nameGap: 46 }),
    series: series.map(({ name, points }, i) => ({
      type: 'line', name, data: points, symbol: SYMBOLS[Math.floor(i / 7 + i) % SYMBOLS.length], symbolSize: 7,
      lineStyle: { width: 2.2, type: i < 7 ? 'solid' : 'dashed' }, itemStyle: { color: seriesColour(i) },
      color: seriesColour(i), emphasis: { focus: 'series' },
    })),
  };
}

// Draws into an element; show({ x, y, series: [{ name, points }] }) changes what is drawn.
export class Curves {
  constructor(element) {
    this.element = element;
    this.chart = init(element, null, { renderer: 'canvas' });
    new ResizeObserver(() => this.draw()).observe(element);
    dark.addEventListener('change', () => this.draw());
  }

  show(content) {
    this.content = content;
    this.draw();
  }

  draw() {
    if (this.content) {
      this.chart.resize();
      this.chart.setOption(options({ ...this.content, phone: this.element.clientWidth < 560 }), true);
    }
  }
}
