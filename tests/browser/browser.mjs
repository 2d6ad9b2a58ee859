// Pages in a headless Chromium, and what they do wrong.
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join } from 'node:path';
import { chromium } from 'playwright-core';

const axe = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');
const WAIT_MS = 30000;

// Runs in the page before its own scripts: collects layout that moves without anybody's doing.
function watchLayout() {
  window.layoutShifts = [];
  new PerformanceObserver((list) => {
    for (const entry of list.getEntries().filter(({ hadRecentInput }) => !hadRecentInput)) {
      window.layoutShifts.push({
        value: entry.value,
        what: entry.sources.map(({ node }) => (node?.id ? `#${node.id}` : node?.nodeName)).join(' '),
      });
    }
  }).observe({ type: 'layout-shift', buffered: true });
}

// On a machine without a graphics card Chromium draws WebGL by software, and says what that costs.
export const BY_SOFTWARE = /GPU stall due to ReadPixels/;

export class Browser {
  constructor(program, check) {
    this.program = program;
    this.check = check;
    this.browser = null;
  }

  // url: of the daemon, the only host that pages may ask.
  async start(url) {
    this.url = url;
    this.browser = await chromium.launch({
      executablePath: this.program,
      args: ['--no-sandbox', '--disable-quic', '--disable-dev-shm-usage', '--enable-unsafe-swiftshader'],
    });
  }

  async stop() {
    await this.browser?.close();
  }

  // Opens a path of the daemon in a page of its own, without anything kept from before. settings:
  // width, height, scheme ("light" or "dark"), script (false: none), routes ({ pattern: handler } as of
  // Playwright, for answers that stand in), state (cookies of another visit).
  async open(path, { width = 1280, height = 900, scheme = 'light', script = true, routes = {}, state } = {}) {
    const context = await this.browser.newContext({
      viewport: { width, height }, colorScheme: scheme, javaScriptEnabled: script, storageState: state,
      reducedMotion: 'reduce',
    });
    context.setDefaultTimeout(WAIT_MS);
    await context.addInitScript(watchLayout);
    const page = await context.newPage();
    for (const [pattern, handler] of Object.entries(routes)) {
      await page.route(pattern, handler);
    }
    const visit = new Visit(page, this);
    await visit.go(path);
    return visit;
  }
}

class Visit {
  constructor(page, { url, check }) {
    this.page = page;
    this.url = url;
    this.check = check;
    this.problems = [];
    page.on('console', (message) => {
      if (['error', 'warning'].includes(message.type())) {
        this.problems.push(`console: ${message.text()}`);
      }
    });
    page.on('pageerror', (error) => this.problems.push(`uncaught: ${error.stack}`));
    page.on('requestfailed', (request) => {
      const { errorText } = request.failure();
      if (errorText !== 'net::ERR_ABORTED') { // by the page itself, as when one leaves it
        this.problems.push(`failed: ${request.url()} ${errorText}`);
      }
    });
    page.on('request', (request) => {
      const asked = new URL(request.url());
      if (asked.origin !== this.url && !['data:', 'blob:'].includes(asked.protocol)) {
        this.problems.push(`another host: ${request.url()}`);
      }
    });
  }

  async go(path) {
    await this.page.goto(`${this.url}${path}`, { waitUntil: 'load' });
  }

  close() {
    return this.page.context().close();
  }

  // Waits until a function of the page gives true.
  async until(name, condition, argument) {
    try {
      await this.page.waitForFunction(condition, argument, { timeout: WAIT_MS });
      this.check(name, true);
    } catch (problem) {
      this.check(name, false, String(problem.message).split('\n')[0]);
    }
  }

  // What a function of the page gives.
  value(expression, argument) {
    return this.page.evaluate(expression, argument);
  }

  // Forgets what the page did wrong, and gives it.
  takeProblems() {
    return this.problems.splice(0);
  }

  // Layout that moved by itself so far: the sum that is known as CLS, and what moved.
  async shift() {
    const shifts = await this.value(() => window.layoutShifts ?? []);
    return { total: shifts.reduce((sum, { value }) => sum + value, 0), shifts };
  }

  // The page did nothing wrong since the last time, but for what matches `but`.
  async quiet(name = 'the page complains about nothing', but = null) {
    await this.page.waitForTimeout(50); // what is on its way
    const problems = this.takeProblems().filter((text) => !but?.test(text));
    this.check(name, problems.length === 0, problems.join('\n  '));
  }

  // Nothing moved by itself, up to what nobody sees.
  async still(name = 'nothing on the page moves by itself') {
    const { total, shifts } = await this.shift();
    this.check(name, total <= 0.01, `${total.toFixed(4)}: ${JSON.stringify(shifts)}`);
  }

  // Nothing sticks out of the window sideways.
  async fits(name = 'the page fits its window') {
    const [content, window] = await this.value(() => [document.documentElement.scrollWidth, innerWidth]);
    this.check(name, content <= window, `${content} pixels in ${window}`);
  }

  // No serious violation of accessibility.
  async accessible(name = 'axe finds nothing serious') {
    await this.value(axe);
    const found = await this.value(() => window.axe.run(document, { resultTypes: ['violations'] })
      .then(({ violations }) => violations.filter(({ impact }) => ['serious', 'critical'].includes(impact))
        .map(({ id, nodes }) => `${id}: ${nodes.slice(0, 3).map(({ html, failureSummary }) =>
          `${html.slice(0, 150)} ${failureSummary.replaceAll(/\s+/g, ' ').slice(0, 250)}`).join(' | ')}`)));
    this.check(name, found.length === 0, found.join('\n  '));
  }

  // A picture of the whole page.
  async shot(name, fullPage = true) {
    if (process.env.PAGES_SHOTS) {
      await this.page.screenshot({ path: join(process.env.PAGES_SHOTS, `${name}.png`), fullPage });
    }
  }
}

// Pages (names and paths) on a desk and a phone, light and dark: they fit, keep still, are accessible.
export async function visitSizes(open, pages) {
  for (const [width, height, scheme] of [[1280, 900, 'light'], [390, 844, 'dark']]) {
    for (const [name, path] of Object.entries(pages)) {
      const what = `${name}-${width}-${scheme}`;
      const visit = await open(path, { width, height, scheme });
      await visit.page.waitForLoadState('networkidle');
      await visit.fits(`${what} fits`);
      await visit.still(`${what} is still`);
      await visit.accessible(`${what} is accessible`);
      await visit.quiet(`${what} complains about nothing`, BY_SOFTWARE);
      await visit.shot(what);
      await visit.close();
    }
  }
}
