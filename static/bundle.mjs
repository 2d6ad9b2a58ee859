// Bundles the libraries of the pages: each file of bundle/ becomes one ES module with what it exports,
// compressed beside it, and the licences of the packages that went into it.
// usage: node bundle.mjs SOURCE_FOLDER TARGET_FOLDER NAME..., where node_modules is
import { mkdirSync, readFileSync, readdirSync, statSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join } from 'node:path';
import { brotliCompressSync, constants } from 'node:zlib';

const [source, target, ...names] = process.argv.slice(2);
const home = process.cwd();
const packages = join(home, 'node_modules');
const { build } = createRequire(join(packages, 'here.js'))('esbuild');

// The policy of the pages lets no script turn text into markup, which includes no text. The painter of
// ECharts empties its element so, before it draws on canvases only.
const emptying = {
  name: 'empty an element without markup',
  setup({ onLoad }) {
    onLoad({ filter: /zrender[/\\]lib[/\\]canvas[/\\]Painter\.js$/ }, ({ path }) => {
      const parts = readFileSync(path, 'utf8').split("root.innerHTML = ''");
      if (parts.length !== 3) {
        throw new Error(`${path}: two places that empty an element were expected, found ${parts.length - 1}`);
      }
      return { contents: parts.join('root.replaceChildren()'), loader: 'js' };
    });
  },
};

// The packages whose files are in the bundle.
function packagesOf(metafile) {
  const found = Object.keys(metafile.inputs).map((path) => /node_modules\/((?:@[^/]+\/)?[^/]+)/.exec(path)?.[1]);
  return [...new Set(found.filter(Boolean))].sort();
}

function noticeOf(name) {
  const folder = join(packages, name);
  const { version, license } = JSON.parse(readFileSync(join(folder, 'package.json'), 'utf8'));
  const texts = readdirSync(folder, { recursive: true })
    .filter((file) => /^(licen[cs]es?|notice|copying)\b/i.test(file) && statSync(join(folder, file)).isFile())
    .sort().map((file) => readFileSync(join(folder, file), 'utf8').trim());
  if (texts.length === 0) {
    throw new Error(`the package ${name} has no text of its licence`);
  }
  return [`${name} ${version} (${license})`, ...texts].join('\n\n');
}

async function bundle(name) {
  const file = join(target, `${name}.js`);
  const { metafile } = await build({
    stdin: { contents: readFileSync(join(source, `${name}.js`), 'utf8'), resolveDir: home, sourcefile: `${name}.js` },
    outfile: file,
    bundle: true,
    format: 'esm',
    target: 'es2020',
    minify: true,
    legalComments: 'none',
    banner: { js: `/* Authors and licences: see ${name}.txt beside this. */` },
    define: { 'process.env.NODE_ENV': '"production"' },
    metafile: true,
    logLevel: 'warning',
    plugins: [emptying],
  });
  writeFileSync(`${file}.br`, brotliCompressSync(readFileSync(file), {
    params: { [constants.BROTLI_PARAM_QUALITY]: constants.BROTLI_MAX_QUALITY },
  }));
  const notices = packagesOf(metafile).map(noticeOf);
  writeFileSync(join(target, `${name}.txt`), `${notices.join(`\n\n${'-'.repeat(78)}\n\n`)}\n`);
}

mkdirSync(target, { recursive: true });
for (const name of names) {
  await bundle(name);
}
