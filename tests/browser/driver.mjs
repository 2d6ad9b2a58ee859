// What the tests of the pages share: a real daemon, a real Chromium, and checks that count.
//
// import { lab } from './driver.mjs';
// await lab(async ({ daemon, open, check }) => {
//   const job = await daemon.submit({ kind: 'response', ... });  // solved
//   const visit = await open(`/jobs/${job.id}`);                 // a page, and what it does wrong
//   await visit.until('the state is shown', () => document.getElementById('state').textContent === 'succeeded');
//   await visit.accessible();
//   await visit.quiet();
// });
//
// Every page is watched: messages of its console, errors that nobody caught, failed requests and refused
// ones, requests to other hosts, and layout that moves by itself. quiet() says that there was nothing of
// the kind since the last time. PAGES_SHOTS=DIR keeps the pictures that shot() takes.
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { Browser } from './browser.mjs';
import { Daemon } from './daemon.mjs';

let failures = 0;
let passes = 0;

// Counts and prints what holds and what does not.
export function check(name, holds, found = '') {
  if (holds) {
    passes += 1;
    console.log(`ok: ${name}`);
  } else {
    failures += 1;
    console.log(`FAILED: ${name}${found === '' ? '' : `\n  ${found}`}`);
  }
  return Boolean(holds);
}

// Runs a test: the daemon's options are of its command line. Ends the process.
export async function lab(body, { options = [], prepare = null } = {}) {
  const work = mkdtempSync(join(tmpdir(), 'pneulab-browser-'));
  const daemon = new Daemon(process.env.BIN, work);
  const browser = new Browser(process.env.CHROMIUM, check);
  try {
    const prepared = prepare ? await prepare(daemon) : null;
    await daemon.start(options);
    await browser.start(daemon.url);
    await body({ daemon, check, prepared, open: (path, settings) => browser.open(path, settings) });
  } catch (problem) {
    check('the test runs to its end', false, problem.stack);
    console.log(daemon.log());
  } finally {
    await browser.stop();
    await daemon.stop();
    rmSync(work, { recursive: true, force: true });
  }
  console.log(`${passes} passed, ${failures} failed`);
  process.exit(failures === 0 ? 0 : 1);
}
