// Compares the schema checker (check_lines) with ajv for JSON Schema 2020-12: over all job
// documents of the project, wrong ones, and thousands of changed ones both must come to the same
// verdict, and where they refuse a document, to the same first place (see first.mjs).
//   node differential.mjs SOURCE CHECK_LINES [COUNT]
import { spawnSync } from 'node:child_process';
import { readdirSync, readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join } from 'node:path';
import { choose, firstPointer } from './first.mjs';
import { readQuantity } from './quantity.mjs';

const [source, checker, count = '4000'] = process.argv.slice(2);
const require = createRequire(join(process.cwd(), 'node_modules', 'none.cjs'));
const { default: Ajv } = require('ajv/dist/2020.js');
const schema = JSON.parse(readFileSync(join(source, 'schema/job.schema.json'), 'utf8'));

// ---- ajv with the keywords for quantities, and with the choice of branches ----

function makeAjv() {
  const ajv = new Ajv({ allErrors: true, strict: true, strictTypes: false, strictRequired: false });
  ajv.addKeyword({
    keyword: 'x-unit',
    schemaType: 'string',
    validate: (unit, value) => typeof value === 'string' && readQuantity(value, unit) !== null,
  });
  const bound = (keyword, fits) => ajv.addKeyword({
    keyword,
    type: 'string',
    schemaType: 'string',
    validate: (limit, value, node) => {
      const si = readQuantity(value, node['x-unit']);
      return si === null || fits(si, readQuantity(limit, node['x-unit']));
    },
  });
  bound('x-minimum', (value, limit) => value >= limit);
  bound('x-exclusiveMinimum', (value, limit) => value > limit);
  bound('x-maximum', (value, limit) => value <= limit);
  return ajv;
}

const verdictOf = makeAjv().compile(schema);

function withChoices(node) {
  if (Array.isArray(node)) {
    return node.map(withChoices);
  }
  if (node === null || typeof node !== 'object') {
    return node;
  }
  return Object.fromEntries(Object.entries(node).map(([key, child]) =>
    [key === 'oneOf' ? 'x-choose' : key, key === 'oneOf' ? child : withChoices(child)]));
}

function makeChooser() {
  const ajv = makeAjv();
  const changed = withChoices(schema);
  const compiled = new Map();
  const validatorOf = (branch) => {
    const key = JSON.stringify(branch);
    if (!compiled.has(key)) {
      compiled.set(key, ajv.compile({ ...withChoices(branch), $defs: changed.$defs }));
    }
    return compiled.get(key);
  };
  ajv.addKeyword({
    keyword: 'x-choose',
    errors: 'full',
    compile: (branches) => function check(value, context) {
      const chosen = choose(schema, branches, value);
      if (chosen.branch) {
        const validate = validatorOf(chosen.branch);
        const valid = validate(value, context);
        check.errors = validate.errors?.map((error) => ({ ...error })) ?? null;
        return valid;
      }
      check.errors = [{ keyword: 'x-choose', instancePath: context.instancePath, params: chosen }];
      return false;
    },
  });
  delete changed.$id;
  return ajv.compile(changed);
}

const errorsOf = makeChooser();

// ---- documents ----

function filesBelow(directory) {
  return readdirSync(directory, { withFileTypes: true }).flatMap((entry) =>
    entry.isDirectory() ? filesBelow(join(directory, entry.name)) : [join(directory, entry.name)]);
}

function parsed(text) {
  try {
    return [JSON.parse(text)];
  } catch {
    return [];
  }
}

const jobs = filesBelow(join(source, 'jobs')).filter((name) => name.endsWith('.json')).sort()
  .flatMap((name) => parsed(readFileSync(name, 'utf8'))).filter((job) => job.kind);
const manual = filesBelow(join(source, 'docs')).filter((name) => name.endsWith('.md')).sort()
  .flatMap((name) => [...readFileSync(name, 'utf8').matchAll(/```json\n(.*?)```/gs)])
  .flatMap((block) => parsed(block[1])).filter((job) => job?.kind);
const corpus = filesBelow(join(source, 'tests/fuzz/corpus/job')).sort()
  .flatMap((name) => parsed(readFileSync(name, 'utf8')))
  .filter((job) => job !== null && typeof job === 'object');

// ---- changes ----

let state = 1;
const random = (limit) => { // xorshift: the same documents each time
  state ^= state << 13;
  state ^= state >>> 17;
  state ^= state << 5;
  return (state >>> 0) % limit;
};
const pick = (list) => list[random(list.length)];

const values = [0, 1, -1, 1.5, 10.0, 41, 65, 1e300, true, false, null, '', [], {}, '2 mm', '5 kPa',
  '0 mm', '-1 mm', '2 deg', '3 s', '1e-3 m', '2 km', '1e400 mm', '5', 'mm', '2 furlongz', '2 mm mm',
  '1 N s/m', '1 kg', '5 g', '2 GiB', '1 MB', '-300 kPa', '7 min', '8 d', '1 N/m', '1 1/s', '1 psi',
  '0.5 MPa', 'B', 'fast', 'pneunet', 'response', 'verify', 'hertz-cylinder', 'yeoh',
  'dragon-skin-20', 'x'.repeat(151), '€'.repeat(150), 'x'.repeat(2001), [1, 2, 3], ['2 mm'],
  Array(51).fill('a'), ['1 kPa', '2 kPa'], { a: 'b' }, { base: '20 mm', tip: '12 mm' },
  { model: 'yeoh' }, { model: 'yeoh', C: ['1 MPa'] }, { model: 'ogden', mu: ['1 MPa'], alpha: [1] },
  { per: 'psi', coefficients: ['1 N/m'] }, { times: -0.5 }, { steady: '3 psi' }];

function collect(node, keys, examples) {
  if (Array.isArray(node)) {
    node.forEach((child) => collect(child, keys, examples));
  } else if (node !== null && typeof node === 'object') {
    Object.keys(node.properties ?? {}).forEach((key) => keys.add(key));
    (Array.isArray(node.examples) ? node.examples : []).forEach((value) => examples.push(value));
    Object.values(node).forEach((child) => collect(child, keys, examples));
  }
}

const known = new Set();
const examples = [];
collect(schema, known, examples);
const keys = [...known, 'unknown', 'a/b', 'c~d'];

function places(node, path = []) {
  const members = node !== null && typeof node === 'object' ? Object.entries(node) : [];
  return [[path, node], ...members.flatMap(([key, child]) => places(child, [...path, key]))];
}

// Replaces, removes or adds one member or item somewhere.
function change(document) {
  const [path, node] = pick(places(document));
  const value = structuredClone(random(3) === 0 ? pick(examples) : pick(values));
  const action = random(10);
  if (action < 3 && Array.isArray(node)) {
    node.push(value);
  } else if (action < 3 && node !== null && typeof node === 'object') {
    node[pick(keys)] = value;
  } else if (path.length > 0) {
    const parent = path.slice(0, -1).reduce((at, key) => at[key], document);
    const key = path.at(-1);
    if (action >= 5) {
      parent[key] = value;
    } else if (Array.isArray(parent)) {
      parent.splice(Number(key), 1);
    } else {
      delete parent[key];
    }
  }
}

const seeds = [...jobs, ...manual, ...corpus].filter((job) => JSON.stringify(job).length < 6000);
const changed = Array.from({ length: Number(count) }, () => {
  const document = structuredClone(pick(seeds));
  for (let changes = pick([1, 1, 1, 2, 3]); changes > 0; changes--) {
    change(document);
  }
  return document;
});

// ---- comparison ----

const documents = [...jobs, ...manual, ...corpus, ...changed];
const run = spawnSync(checker, [join(source, 'schema/job.schema.json')], {
  input: documents.map((document) => `${JSON.stringify(document)}\n`).join(''),
  encoding: 'utf8',
  maxBuffer: 1 << 28,
});
const lines = run.stdout.split('\n');
let accepted = 0;
let verdicts = 0;
let pointers = 0;
documents.forEach((document, i) => {
  const [ours, sentence] = JSON.parse(lines[i]);
  const valid = verdictOf(document);
  accepted += valid;
  if (valid !== (ours === 'ok')) {
    verdicts += 1;
    console.log(`ajv ${valid}, ours ${lines[i]}\n  ${JSON.stringify(document).slice(0, 600)}`);
    return;
  }
  errorsOf(document);
  const first = valid ? 'ok' : firstPointer(schema, errorsOf.errors ?? [], document);
  if (first !== ours && Buffer.byteLength(first ?? '') < 200) {
    pointers += 1;
    console.log(`first of ajv ${first}, ours ${ours}: ${sentence}\n  ${
      JSON.stringify(document).slice(0, 600)}`);
  }
});
console.log(`${jobs.length + manual.length} jobs, ${corpus.length} of the corpus, ${
  changed.length} changed: ${accepted} accepted, ${verdicts} verdicts and ${pointers} pointers differ`);
process.exitCode = run.status === 0 && verdicts === 0 && pointers === 0 && accepted > 300 ? 0 : 1;
