// Takes the picture of a page of a daemon that runs, as those in docs/figures/study:
//
//   BIN=. tests/browser/run.sh picture.mjs URL OUT.png [KEY=VALUE ...]
//
// width (960), height (of the window, 700), scheme (light or dark), from and to: selectors; the picture
// goes from the top of the one to the bottom of the other (the whole window unless given), hide: a
// selector of what is left out, wait: a selector that is waited for.
import { resolve } from 'node:path';
import { Browser } from './browser.mjs';

const SETTLED_MS = 1500; // charts have no state that says that they are drawn

function complain(name, holds, found = '') {
  if (!holds) {
    throw new Error(`${name}: ${found}`);
  }
}

// Goes down the page, since charts are drawn when they come into sight.
async function scrollThrough(visit) {
  await visit.value(async () => {
    for (let y = 0; y < document.body.scrollHeight; y += 500) {
      window.scrollTo(0, y);
      await new Promise((next) => {
        setTimeout(next, 80);
      });
    }
    window.scrollTo(0, 0);
  });
}

// The part of the page from the top of one element to the bottom of another, over its whole width.
async function part(visit, from, to) {
  const [top, bottom, width] = await visit.value(
    ([first, last]) => [
      document.querySelector(first).getBoundingClientRect().top + window.scrollY,
      document.querySelector(last).getBoundingClientRect().bottom + window.scrollY,
      document.documentElement.clientWidth,
    ],
    [from, to],
  );
  return { x: 0, y: Math.max(top - 8, 0), width, height: bottom - Math.max(top - 8, 0) + 8 };
}

async function take(url, file, { width = '960', height = '700', scheme, from, to, hide, wait }) {
  const { origin, pathname, search } = new URL(url);
  const browser = new Browser(process.env.CHROMIUM, complain);
  await browser.start(origin);
  try {
    const visit = await browser.open(pathname + search, { width: Number(width), height: Number(height), scheme });
    if (hide) {
      await visit.page.addStyleTag({ content: `${hide} { display: none !important }` });
    }
    if (wait) {
      await visit.page.waitForSelector(wait);
    }
    await scrollThrough(visit);
    await visit.page.waitForTimeout(SETTLED_MS);
    const clip = from ? await part(visit, from, to ?? from) : undefined;
    await visit.page.screenshot({ path: file, clip, fullPage: Boolean(clip) });
    await visit.quiet();
  } finally {
    await browser.stop();
  }
}

const [url, file, ...settings] = process.argv.slice(2);
if (!file) {
  console.error('picture.mjs URL OUT.png [KEY=VALUE ...]');
  process.exit(2);
}
await take(url, resolve(process.env.CALLED_FROM, file), Object.fromEntries(settings.map((text) => text.split(/=(.*)/s))));
