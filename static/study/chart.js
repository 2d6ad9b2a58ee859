// Charts of ECharts in the colours of the page. The library is loaded when the first one comes into sight.

import { dark, pageColour } from './paint.js';

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

export class Chart {
  // place: an element of a size of its own.
  constructor(place) {
    this.place = place;
    this.build = null;
    this.chart = null;
    new ResizeObserver(() => this.chart?.resize()).observe(place);
    dark.addEventListener('change', () => this.renew());
  }

  // build: makes the options with the colours of the time. text: what the chart shows, in words.
  async show(build, text) {
    this.build = build;
    this.place.setAttribute('role', 'img');
    this.place.setAttribute('aria-label', text);
    const { init } = await load();
    this.init = init;
    this.chart ??= init(this.place, theme(), { renderer: 'canvas' });
    this.draw();
  }

  draw() {
    this.chart.setOption({ animation: false, ...this.build() }, { notMerge: true });
  }

  // Colours belong to the chart from its beginning.
  renew() {
    if (this.chart) {
      const listeners = this.listeners ?? [];
      this.chart.dispose();
      this.chart = this.init(this.place, theme(), { renderer: 'canvas' });
      listeners.forEach(([event, listener]) => this.chart.on(event, listener));
      this.draw();
    }
  }

  on(event, listener) {
    this.listeners = [...(this.listeners ?? []), [event, listener]];
    this.chart.on(event, listener);
  }

  picture() {
    return this.chart?.getDataURL({ pixelRatio: 2, backgroundColor: pageColour('card') });
  }
}

// Calls `start` once when a part of the page first comes near the window.
export function whenSeen(place, start) {
  const watcher = new IntersectionObserver((entries) => {
    if (entries.some(({ isIntersecting }) => isIntersecting)) {
      watcher.disconnect();
      start();
    }
  }, { rootMargin: '200px' });
  watcher.observe(place);
}
