// The pages about the API and the formats: whole, without scripts, of this server alone.
import { lab } from './driver.mjs';

async function testWhole({ open, check }, path) {
  for (const [width, scheme] of [[1280, 'light'], [390, 'dark']]) {
    const visit = await open(path, { width, scheme });
    check(`${path} links to places that are there`, await visit.value(() => [...document.querySelectorAll('a[href^="#"]')]
      .every((link) => document.getElementById(link.getAttribute('href').slice(1)))));
    check(`${path} has no script`, await visit.value(() => document.scripts.length) === 0);
    check(`${path} has its styles`, await visit.value(() => getComputedStyle(document.querySelector('.docs')).display) === 'grid');
    check(`${path} names no id twice`, await visit.value(() => {
      const ids = [...document.querySelectorAll('[id]')].map(({ id }) => id);
      return new Set(ids).size === ids.length;
    }));
    await visit.fits(`${path} fits (${width})`);
    await visit.quiet(`${path} complains about nothing`);
    await visit.close();
  }
}

async function testComplete({ open, check }) {
  const visit = await open('/docs');
  check('every operation is there', await visit.value(async () => {
    const api = await (await fetch('/openapi.json')).json();
    const ids = Object.values(api.paths).flatMap((item) => Object.values(item)).map(({ operationId }) => operationId)
      .filter(Boolean);
    return ids.length > 25 && ids.every((id) => document.getElementById(id.toLowerCase()));
  }));
  await visit.go('/docs/job');
  check('every key of a response is there', await visit.value(async () => {
    const schema = await (await fetch('/api/v1/schemas/job')).json();
    const shown = new Set([...document.querySelectorAll('#response th code')].map((code) => code.textContent));
    return Object.keys(schema.$defs.response.properties).every((key) => shown.has(key));
  }));
  await visit.go('/');
  check('the list links to the pages about the API', await visit.page.locator('nav a[href="/docs"]').count() === 1);
  await visit.close();
}

await lab(async (tools) => {
  for (const path of ['/docs', '/docs/job', '/docs/result']) {
    await testWhole(tools, path);
  }
  await testComplete(tools);
});
