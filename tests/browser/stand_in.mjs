// Answers for a study of any size, in the form of those of the daemon: what the page makes of thousands of
// designs does not depend on who solved them.

// A generator of reproducible numbers in [0, 1) (Park and Miller 1988).
function generator(seed) {
  let state = seed;
  return () => {
    state = (state * 48271) % 2147483647;
    return state / 2147483647;
  };
}

const PARAMETERS = [
  ['/actuator/chamber_gap', 'chamber gap', 'mm', 1, 3],
  ['/actuator/side_wall', 'side wall', 'mm', 1.5, 3],
  ['/actuator/top_wall', 'top wall', 'mm', 1.5, 3],
  ['/actuator/bottom_layer', 'bottom layer', 'mm', 3, 6],
];
const METRICS = [
  ['bending_angle_deg', 'Bending angle', '°'],
  ['mass_g', 'Mass', 'g'],
  ['max_stretch', 'Largest stretch', ''],
  ['tip_deflection_mm', 'Tip deflection', 'mm'],
];
const MATERIALS = ['dragon-skin-20', 'dragon-skin-30', 'elastic-50a'];

// A smooth model of a finger, good enough to look at.
function solved(gap, side, top, bottom, stiffness) {
  const angle =
    ((140 * Math.exp(-0.5 * (side - 1.5) - 0.7 * (top - 1.5)) * (0.7 + 0.25 * gap)) / stiffness) *
    (1 - 0.05 * (bottom - 4) ** 2);
  const mass = 18 + 5.5 * side + 4 * top + 6.2 * bottom - 1.6 * gap;
  return [angle, mass, 1.1 + angle / 220 + 0.04 * gap, 48 * (1 - Math.cos((angle * Math.PI) / 260))];
}

// The answer of /designs?format=columns for `count` designs; every 50th has failed, with metrics of no use.
function columnsOf(count) {
  const random = generator(7);
  const values = Array.from({ length: 9 }, () => []);
  const states = [];
  for (let i = 0; i < count; i++) {
    const parts = PARAMETERS.map(([, , , low, high]) => low + random() * (high - low));
    const material = Math.floor(random() * 3);
    const hasFailed = i % 50 === 49;
    const metrics = solved(...parts, [0.8, 1, 1.5][material]);
    [...parts, material, ...metrics.map((value) => (hasFailed ? 999 : value * (1 + 0.02 * (random() - 0.5))))].forEach(
      (value, k) => values[k].push(value),
    );
    states.push(hasFailed ? 'failed' : 'succeeded');
  }
  const number =
    (role) =>
    ([key, title, unit]) => ({ key, title, unit, role, categorical: false, words: [] });
  return {
    columns: [
      ...PARAMETERS.map(number('parameter')),
      { key: '/material', title: 'material', unit: '', role: 'parameter', categorical: true, words: MATERIALS },
      ...METRICS.map(number('metric')),
    ],
    members: states.map((_, i) => i),
    jobs: states.map((_, i) => 1000 + i),
    states,
    reasons: states.map((state) => (state === 'failed' ? 'diverged' : '')),
    names: states.map((_, i) => `design ${i}`),
    values,
  };
}

function summaryOf(id, count) {
  const failed = Math.floor(count / 50);
  return {
    id,
    name: 'walls, gap and material of a finger',
    state: 'succeeded',
    sampling: 'sobol',
    extendable: true,
    members: count,
    stored: count,
    counts: { succeeded: count - failed, failed },
    failures: [{ reason_code: 'diverged', count: failed, jobs: [1049, 1099, 1149] }],
  };
}

const surrogate = {
  method: 'Gaussian process, Matern 5/2',
  points: 600,
  complete: 9800,
  succeeded: 9800,
  members: 10000,
  r2: 0.987,
  within_95: 0.94,
};

const parameters = [
  ...PARAMETERS.map(([key, title, unit]) => ({ key, title, unit })),
  { key: '/material', title: 'material', unit: '' },
];
const metricOf = (key) => {
  const [, title, unit] = METRICS.find(([name]) => name === key);
  return { key, title, unit };
};

function importance(query) {
  const shares = [0.42, 0.27, 0.09, 0.05, 0.16];
  const share = (value) => ({ value, low: value - 0.02, high: value + 0.02 });
  return {
    metric: metricOf(query.get('metric')),
    surrogate,
    samples: 4096,
    method: 'Sobol’ indices of the surrogate',
    parameters: parameters
      .map((one, i) => ({
        ...one,
        first: share(shares[i] * 0.9),
        total: share(shares[i]),
        pearson: 0.5,
        spearman: 0.5,
      }))
      .sort((a, b) => b.total.value - a.total.value),
  };
}

function effects(query) {
  const main = parameters.map((one, k) => {
    const isWord = k === 4;
    const at = isWord
      ? MATERIALS
      : Array.from({ length: 17 }, (_, i) => PARAMETERS[k][3] + (i / 16) * (PARAMETERS[k][4] - PARAMETERS[k][3]));
    const mean = at.map((_, i) => 60 + (k - 2) * 12 * (i / (at.length - 1) - 0.5) + (k === 1 ? (-30 * i) / 16 : 0));
    return { ...one, at, mean, low: mean.map((v) => v - 12), high: mean.map((v) => v + 14) };
  });
  return {
    metric: metricOf(query.get('metric')),
    surrogate,
    samples: 4096,
    main,
    pairs: [{ keys: [parameters[1].key, parameters[2].key], share: { value: 0.04, low: 0.03, high: 0.05 } }],
  };
}

function slice(query) {
  const axis = (key) => {
    const k = parameters.findIndex((one) => one.key === key);
    const values =
      k === 4
        ? MATERIALS
        : Array.from({ length: 33 }, (_, i) => PARAMETERS[k][3] + (i / 32) * (PARAMETERS[k][4] - PARAMETERS[k][3]));
    return { ...parameters[k], logarithmic: false, values };
  };
  const x = axis(query.get('x'));
  const y = query.get('y') ? axis(query.get('y')) : null;
  const rows = y ? y.values : [0];
  const mean = rows.map((_, j) =>
    x.values.map((__, i) => 120 * Math.exp(-(((i - 20) / 20) ** 2) - ((j - 8) / 15) ** 2)),
  );
  return {
    metric: metricOf(query.get('metric')),
    surrogate,
    x,
    y,
    at: { '/actuator/top_wall': 2.2 },
    mean,
    deviation: mean.map((row) => row.map((v) => 1 + v / 40)),
  };
}

function quality(query) {
  const random = generator(3);
  const known = Array.from({ length: 400 }, () => 20 + 110 * random());
  return {
    metric: metricOf(query.get('metric')),
    surrogate,
    mean: 60,
    deviation: 20,
    noise: 1,
    parameters: [],
    left_out: {
      members: known.map((_, i) => i),
      jobs: known.map((_, i) => 1000 + i),
      known,
      predicted: known.map((v) => v + 8 * (random() - 0.5)),
      deviation: known.map(() => 2.2),
    },
  };
}

function pareto(query, document) {
  const objectives = query
    .get('objectives')
    .split(',')
    .map((part) => part.split(':'))
    .map(([direction, key]) => ({ ...metricOf(key), direction }));
  const data = objectives.map(({ key }) => document.values[document.columns.findIndex((column) => column.key === key)]);
  const signs = objectives.map(({ direction }) => (direction === 'max' ? -1 : 1));
  const rows = document.jobs
    .map((_, i) => i)
    .filter((i) => data[0][i] !== null)
    .sort((a, b) => signs[0] * (data[0][a] - data[0][b]));
  let best = Infinity;
  const front = rows.filter((row) => {
    const value = objectives.length > 1 ? signs[1] * data[1][row] : 0;
    const isBetter = value < best;
    best = Math.min(best, value);
    return isBetter;
  });
  return {
    objectives,
    compared: rows.length,
    excluded: 200,
    layers: [front.length],
    hypervolume: { value: 1, share: 0.7, exact: true, standard_error: 0 },
    designs: front.map((row) => ({
      member: row,
      job: document.jobs[row],
      name: document.names[row],
      layer: 1,
      values: data.map((column) => column[row]),
    })),
  };
}

function ranking(query, document) {
  const criteria = query
    .get('criteria')
    .split(',')
    .map((part) => part.split(':'));
  return {
    preset: null,
    compared: 9800,
    excluded: 200,
    criteria: criteria.map(([direction, key, weight]) => ({
      ...metricOf(key),
      direction,
      weight: Number(weight) / criteria.length,
      low: 0,
      high: 1,
    })),
    designs: Array.from({ length: 15 }, (_, i) => ({
      member: 17 * i,
      job: document.jobs[(17 * i) % document.jobs.length],
      name: '',
      rank: i + 1,
      score: 0.95 - 0.02 * i,
      parts: criteria.map((_c, k) => 0.95 - 0.02 * i * (k + 0.5)),
    })),
  };
}

function search(query) {
  const key = query.get('least') ?? query.get('most');
  const metrics = (deviation) =>
    ['bending_angle_deg', key].map((name, i) => ({ key: name, value: [61.3, 44.2][i], deviation }));
  const values = {
    '/actuator/chamber_gap': 2.4,
    '/actuator/side_wall': 1.62,
    '/actuator/top_wall': 1.7,
    '/actuator/bottom_layer': 3.1,
    '/material': 'dragon-skin-20',
  };
  return {
    goal: { key, direction: 'min' },
    chance: 0.5,
    meeting: 41,
    metrics: ['bending_angle_deg', key].map((name) => ({ ...metricOf(name), surrogate })),
    stored: [{ member: 12, job: 1012, name: 'design 12', predicted: false, values, metrics: metrics(null) }],
    predicted: [
      { predicted: true, values, metrics: metrics(1.2), chance: 0.93, meets: true, document: {}, solved: null },
    ],
  };
}

// Routes for Playwright that answer as if the study `id` had `count` designs.
export function studyRoutes(id, count) {
  const document = columnsOf(count);
  const text = JSON.stringify(document);
  const parts = { importance, effects, slice, surrogate: quality, pareto, ranking, search };
  return {
    [`**/api/v1/jobs/${id}/document`]: (route) =>
      route.fulfill({ contentType: 'application/json', body: '{"kind":"study"}' }),
    [`**/api/v1/studies/${id}**`]: (route) => {
      const url = new URL(route.request().url());
      const part = url.pathname.split('/').at(5) ?? '';
      const body =
        part === 'designs'
          ? text
          : JSON.stringify(
              parts[part]
                ? parts[part](url.searchParams, document)
                : part === 'confirm'
                  ? { id: 77 }
                  : summaryOf(id, count),
            );
      return route.fulfill({ status: part === 'confirm' ? 202 : 200, contentType: 'application/json', body });
    },
  };
}
