// An optimisation step by step: each evaluation, and the best one so far.

import { find } from '../dom.js';
import { number } from '../format.js';
import { chartOf } from './chart.js';
import { lineColour, pageColour, SERIES } from './paint.js';

const TOLERANCE = 1e-3; // of constraints, relative, as the daemon's picture has it
const DECADES = 30; // values that differ by more are seen on a logarithmic scale

// What the values of an optimisation are, from its document's objective.
function labelOf(objective, designs) {
  const metric = objective.minimise ?? objective.maximise;
  if (metric !== undefined) {
    return designs.byKey.get(metric)?.label ?? metric;
  }
  return objective.profile ? 'distance to the profile, rms (mm)' : 'deviation from the targets, rms, relative';
}

function courseOfMetric(column) {
  return {
    label: column.label,
    all: [...column.data].map((value, i) => ({ at: i + 1, value, isAllowed: true })),
  };
}

// history: the list of that name in the study's result.
function courseOfObjective(history, objective, designs) {
  return {
    label: labelOf(objective, designs),
    all: history.map(({ member, value, violation }) => ({
      at: member + 1,
      value: value ?? NaN,
      isAllowed: !(violation > TOLERANCE),
    })),
  };
}

function bestsOf(all, wantsMost) {
  let best = NaN;
  return all.map(({ at, value, isAllowed }) => {
    if (isAllowed && value === value && !(wantsMost ? best >= value : best <= value)) {
      best = value;
    }
    return [at, best === best ? best : null];
  });
}

function isWide(all) {
  const values = all.map(({ value }) => value).filter((value) => value === value);
  return Math.min(...values) > 0 && Math.max(...values) > DECADES * Math.min(...values);
}

export class History {
  constructor() {
    this.chart = chartOf(find('history-plot'));
  }

  // The course of a metric while the search runs; with `history` and `objective`, of what it is after.
  show(designs, column, { history, objective }) {
    const course = history ? courseOfObjective(history, objective, designs) : courseOfMetric(column);
    this.draw(course, objective?.maximise !== undefined);
  }

  draw({ label, all }, wantsMost) {
    const bests = bestsOf(all, wantsMost);
    const points = (test) => all.filter(({ value, isAllowed }) => value === value && test(isAllowed));
    const series = (name, list, symbol, color) => ({
      type: 'scatter',
      name,
      data: list.map(({ at, value }) => [at, value]),
      symbol,
      symbolSize: list.length > 200 ? 5 : 8,
      itemStyle: { color },
    });
    const broken = points((isAllowed) => !isAllowed);
    const best = bests.at(-1)?.[1];
    return this.chart.show(
      () => ({
        grid: { left: 76, right: 20, top: 34, bottom: 48 },
        legend: { top: 0, left: 0, textStyle: { color: pageColour('ink') } },
        xAxis: {
          type: 'value',
          min: 1,
          max: Math.max(all.length, 2),
          minInterval: 1,
          name: 'evaluation',
          nameLocation: 'middle',
          nameGap: 28,
        },
        yAxis: {
          type: isWide(all) ? 'log' : 'value',
          scale: true,
          name: label,
          nameLocation: 'middle',
          nameGap: 54,
        },
        tooltip: { trigger: 'axis', valueFormatter: (value) => (value === undefined ? '–' : number(value)) },
        series: [
          series(
            'each evaluation',
            points((isAllowed) => isAllowed),
            'circle',
            SERIES[4],
          ),
          ...(broken.length > 0 ? [series('breaks a constraint', broken, 'diamond', SERIES[5])] : []),
          {
            type: 'line',
            name: 'best so far',
            data: bests,
            step: 'end',
            symbol: 'none',
            itemStyle: { color: lineColour() },
            lineStyle: { color: lineColour(), width: 2.5 },
          },
        ],
      }),
      `${label} of ${all.length} evaluations; best ${best === null || best === undefined ? 'none yet' : number(best)}`,
    );
  }
}
