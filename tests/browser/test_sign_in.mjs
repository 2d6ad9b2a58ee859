// Signing in, and pages that try what their policy forbids.
import { lab } from './driver.mjs';

async function signIn({ page }, token) {
  await page.fill('#token', token);
  await page.click('main form button');
}

async function testForm({ open, check, prepared }) {
  const visit = await open('/?state=queued');
  await visit.until('a page without a token leads to the form', () => location.pathname === '/sign-in');
  await visit.until('which says nothing yet',
    () => getComputedStyle(document.getElementById('failed')).display === 'none');
  await visit.accessible('the form is accessible');
  await signIn(visit, 'pneulab_wrong');
  await visit.until('a wrong token is refused', () => location.hash === '#failed'
    && getComputedStyle(document.getElementById('failed')).display !== 'none');
  await signIn(visit, prepared);
  await visit.until('the right one leads back', () => location.pathname + location.search === '/?state=queued');
  await visit.until('who it is', () => document.getElementById('caller').textContent === 'alice (submit)');
  await visit.until('the list is read', () => document.getElementById('empty').textContent.length > 0);
  check('scripts cannot read the cookie', await visit.value(() => document.cookie) === '');
  visit.takeProblems(); // the refusals before signing in
  return visit;
}

async function testPolicy(visit, { check }) {
  for (const path of ['/', '/jobs/1', '/sign-in', '/docs', '/docs/job', '/docs/result']) {
    await visit.go(path);
    await visit.quiet(`${path} keeps to its policy`, /404/);
  }
  // What an injection would try is refused by the browser.
  await visit.go('/');
  await visit.value(() => {
    const script = document.createElement('script');
    script.append('window.ran = 1');
    document.head.append(script);
    try {
      document.body.insertAdjacentHTML('beforeend', '<img src=x onerror="window.ran = 2">');
    } catch (problem) {
      window.refused = problem.name;
    }
    const frame = document.createElement('iframe');
    frame.src = '/';
    document.body.append(frame);
  });
  await visit.page.waitForTimeout(200);
  check('an inline script does not run', await visit.value(() => window.ran) === undefined);
  check('markup from text is refused', await visit.value(() => window.refused) === 'TypeError');
  check('nothing is framed', await visit.value(() => {
    const inner = document.querySelector('iframe').contentDocument;
    return inner === null || inner.body.children.length === 0;
  }));
  visit.takeProblems();
}

async function testOut(visit, { check }) {
  await visit.go('/');
  await visit.until('the list is there', () => document.getElementById('caller').textContent !== '');
  await visit.page.click('#session button');
  await visit.until('signed out', () => location.pathname === '/sign-in');
  await visit.go('/');
  await visit.until('and out', () => location.pathname === '/sign-in');
  check('only refusals were complained about', visit.takeProblems().every((text) => /401/.test(text)));
}

await lab(async (tools) => {
  const visit = await testForm(tools);
  await testPolicy(visit, tools);
  await testOut(visit, tools);
}, { prepare: (daemon) => daemon.command('token', 'add', 'alice', '--role', 'submit') });
