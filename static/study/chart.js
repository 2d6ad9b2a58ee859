// Charts of ECharts in the colours of the page. The library is loaded when the first one comes into sight.

import { onColours, pageColour } from './paint.js';

let library = null;

function load() {
  library ??= import('../vendor/echarts.js');
  return library;
}

function theme() {
  const ink = pageColour('ink');
  const axis = {
    axisLine: { lineStyle: { color: pageColour('muted') } },
    axisTick: { lineStyle: { color: pageColour('muted') } },
    axisLabel: { color: ink, fontSize: 11 },
    nameTextStyle: { color: ink, fontSize: 12, fontWeight: 600 },
    splitLine: { lineStyle: { color: pageColour('rule') } },
  };
  return {
    textStyle: { fontFamily: 'system-ui, "DejaVu Sans", sans-serif', color: ink },
    valueAxis: axis,
    categoryAxis: axis,
    logAxis: axis,
    tooltip: {
      renderMode: 'richText',
      backgroundColor: pageColour('card'),
      borderColor: pageColour('rule'),
      textStyle: { color: ink, fontSize: 12 },
    },
  };
}

class Chart {
  constructor(place) {
    this.place = place;
    this.build = null;
    this.chart = null;
    this.onClick = null; // gets the events of ECharts
    new ResizeObserver(() => this.chart && this.draw(true)).observe(place);
    onColours(() => this.renew());
  }

  // build: makes the options with the colours and the size of the time. text: what the chart shows, in
  // words.
  async show(build, text) {
    this.build = build;
    this.place.setAttribute('role', 'img');
    this.place.setAttribute('aria-label', text);
    this.library = await load();
    if (!this.chart) {
      this.start();
    }
    this.draw(false);
  }

  start() {
    this.chart = this.library.init(this.place, theme(), { renderer: 'canvas' });
    this.chart.on('click', (event) => this.onClick?.(event));
  }

  draw(hasNewSize) {
    if (hasNewSize) {
      this.chart.resize();
    }
    this.chart.setOption({ animation: false, ...this.build() }, { notMerge: true });
  }

  // In other colours.
  renew() {
    if (this.chart) {
      this.chart.setTheme(theme());
      this.draw(false);
    }
  }

  picture() {
    return this.chart?.getDataURL({ pixelRatio: 2, backgroundColor: pageColour('card') });
  }
}

const charts = new WeakMap();

// The chart of a place, an element of a size of its own: always the same one.
export function chartOf(place) {
  if (!charts.has(place)) {
    charts.set(place, new Chart(place));
  }
  return charts.get(place);
}

// Calls `start` once when a part of the page first comes near the window.
export function whenSeen(place, start) {
  const watcher = new IntersectionObserver(
    (entries) => {
      if (entries.some(({ isIntersecting }) => isIntersecting)) {
        watcher.disconnect();
        start();
      }
    },
    { rootMargin: '200px' },
  );
  watcher.observe(place);
}
