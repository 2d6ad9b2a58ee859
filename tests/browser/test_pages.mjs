// The pages of jobs, with scripts: list, comparison, editor, a job that runs and one that ended.
import { BY_SOFTWARE, visitSizes } from './browser.mjs';
import { finger } from './daemon.mjs';
import { lab } from './driver.mjs';

const TRICK = '<img src=x onerror=alert(1)> & more';

async function testList({ open, check }) {
  const visit = await open('/');
  await visit.until('the list has all jobs', () => document.querySelectorAll('#jobs tr').length === 3);
  check('the newest is first', await visit.page.textContent('#jobs tr td:nth-child(2)') === '3');
  check('an angle is shown', /^\d+\.\d+°$/.test(await visit.page.textContent('#jobs tr[data-id="1"] td:nth-child(6)')));
  check('markup in a name stays text', await visit.page.textContent('#jobs tr[data-id="2"] .name a') === TRICK);
  check('failures are grouped by reason', await visit.page.textContent('#failures tbody td') === '1');
  await visit.page.check('#pick-1');
  await visit.page.selectOption('#filter-state', 'failed,timed_out');
  await visit.until('the filter hides other states', () => document.querySelectorAll('#jobs tr').length === 1);
  check('filter and selection are in the address', await visit.value(() => location.search)
    === '?state=failed%2Ctimed_out&compare=1');
  await visit.go('/?compare=1');
  await visit.page.check('#pick-2');
  await visit.page.click('#compare-button');
  await visit.until('two jobs are compared', () => location.pathname + location.search === '/compare?jobs=1,2');
  await visit.accessible('the comparison is accessible');
  await visit.quiet('the list complains about nothing', BY_SOFTWARE);
  await visit.close();
}

async function testCompare({ open, check }) {
  const visit = await open('/compare?jobs=1,2');
  await visit.until('the curves are drawn', () => document.querySelector('#curve-chart canvas'));
  await visit.until('the bodies are drawn', () => document.querySelector('.bodies-canvas')?.dataset.drawn > 0);
  check('what differs stands out', await visit.page.textContent('[data-pointer="/actuator/chamber_gap"] mark') === '1 mm');
  check('metrics have their difference', /^[+−±]\d+(\.\d)?\s%$/.test(
    await visit.page.textContent('[data-metric=bending_angle_deg] .difference')));
  const before = await visit.page.locator('.small-plot .shape-canvas').nth(1).screenshot();
  await visit.page.locator('.small-plot .shape-canvas').first().focus();
  await visit.page.keyboard.press('ArrowRight');
  await visit.page.keyboard.press('ArrowUp');
  await visit.page.waitForTimeout(300);
  const after = await visit.page.locator('.small-plot .shape-canvas').nth(1).screenshot();
  check('one camera turns all bodies', !before.equals(after));
  await visit.page.selectOption('#curve-key', 'tip_x_mm');
  check('what is drawn is in the address', await visit.value(() => location.search) === '?jobs=1,2&y=tip_x_mm');
  await visit.still();
  await visit.quiet('the comparison complains about nothing', BY_SOFTWARE);
  await visit.close();
}

async function testEditor({ open, check }) {
  const visit = await open('/submit?from=1');
  const { page } = visit;
  await visit.until('the document is valid', () => /valid/.test(document.querySelector('#verdict .answer')?.textContent));
  check('fields have the dimensions', await page.inputValue('[data-pointer="/actuator/chamber_gap"]') === '2 mm');
  await page.fill('[data-pointer="/actuator/chamber_gap"]', '1.5');
  await page.press('[data-pointer="/actuator/chamber_gap"]', 'Tab');
  check('a field changes the text, with the unit', /"chamber_gap": "1.5 mm"/.test(await page.inputValue('#document')));
  await visit.until('and is checked', () => document.querySelector('#verdict .answer'));
  await visit.accessible('the editor is accessible');
  await visit.still();
  await visit.quiet();
  const good = await page.inputValue('#document');
  await page.fill('#document', good.replace('"20 kPa"', '"20 mm"'));
  await visit.until('a mistake is shown while one writes', () => document.querySelector('#verdict .pointer')?.textContent
    === '/load/pressure/to');
  const line = good.slice(0, good.indexOf('"20 kPa"')).split('\n').length;
  check('at its line', Number(await page.textContent('#gutter .bad')) === line);
  check('and at its field', await page.getAttribute('[data-pointer="/load/pressure/to"]', 'aria-invalid') === 'true');
  await visit.shot('refused');
  await page.fill('#document', '{ "kind": ');
  await visit.until('broken JSON has its place', () => /line 1/.test(document.querySelector('#verdict .place')?.textContent));
  await page.click('#example');
  await visit.until('the example is valid', () => document.querySelector('#verdict .answer'));
  await page.fill('#document', good.replace('"a small finger"', '"from the page"'));
  await visit.until('so is the job', () => document.querySelector('#verdict .answer'));
  await visit.quiet('only the mistakes were complained about', /4(00|22)/);
  await page.click('#submit-form .primary');
  await visit.until('it is accepted', () => /job 4/.test(document.querySelector('#submit-answer a')?.textContent));
  await page.click('#submit-answer a');
  await visit.until('it runs to its end on its page', () => document.getElementById('state').textContent === 'succeeded'
    && document.querySelector('#metric-table'));
  await visit.quiet('the page of a job that runs complains about nothing', BY_SOFTWARE);
  await visit.close();
}

async function testShape({ open, check }) {
  const visit = await open('/jobs/1');
  const { page } = visit;
  const start = Date.now();
  await visit.until('the body is drawn', () => document.getElementById('shape-canvas')?.dataset.drawn > 0);
  console.log(`drawn ${Date.now() - start} ms after the page was loaded`);
  const canvas = page.locator('#shape-canvas');
  const seen = [await canvas.screenshot()];
  const differs = async (name, act) => {
    await act();
    await page.waitForTimeout(250);
    const picture = await canvas.screenshot();
    check(name, seen.every((one) => !one.equals(picture)));
    seen.push(picture);
  };
  await canvas.scrollIntoViewIfNeeded();
  const box = await canvas.boundingBox();
  await differs('the mouse turns it', async () => {
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page.mouse.down();
    await page.mouse.move(box.x + box.width / 2 + 120, box.y + box.height / 2 - 40, { steps: 5 });
    await page.mouse.up();
  });
  await differs('keys turn it', () => page.keyboard.press('ArrowLeft'));
  await differs('and zoom', () => page.keyboard.press('+'));
  await differs('pressure changes it', () => page.fill('#shape-pressure', '400'));
  check('the pressure is named', await page.textContent('#shape-value') === '8\u00a0kPa');
  check('readers of screens are told', /at 8\skPa, coloured by largest stretch from/.test(
    await canvas.getAttribute('aria-label')));
  await differs('colours change', () => page.selectOption('#shape-field', 'von_mises'));
  check('the legend has its unit', await page.textContent('#shape-legend .legend-title') === 'Von Mises stress (kPa)');
  await visit.until('the address says what is seen', () => location.hash === '#shape=8,von_mises');
  await visit.accessible('the job is accessible');
  await visit.still();
  await visit.quiet('the view complains about nothing', BY_SOFTWARE);
  await visit.close();
}

async function testRunning({ open, check, daemon }) {
  const { body } = await daemon.call('POST', '/api/v1/jobs', finger({
    name: 'watched', accuracy: 'standard', load: { pressure: { to: '30 kPa', steps: 60 } } }));
  const visit = await open(`/jobs/${body.id}`);
  await visit.until('progress moves', () => document.getElementById('progress')?.value > 0.02
    && /step \d+ of 60/.test(document.getElementById('percent').textContent));
  await visit.shot('running');
  await visit.page.click('[data-action=cancel]');
  await visit.until('it is cancelled', () => document.getElementById('state').textContent === 'cancelled');
  await visit.until('and can be tried again', () => document.querySelector('[data-action=retry]'));
  await visit.quiet();
  await visit.go('/jobs/3');
  check('a failure has its last load and advice', /Last converged load: \d.*kPa/.test(await visit.page.textContent('#reason'))
    && await visit.page.locator('#reason p').count() === 3);
  await visit.go('/jobs/999999');
  check('a job that does not exist is named', /999999/.test(await visit.page.textContent('#problem')));
  await visit.close();
}

// Without scripts all can be read, at the same addresses.
async function testReading({ open, check }) {
  const visit = await open('/', { script: false });
  const { page } = visit;
  check('the list can be read', await page.locator('#jobs tr').count() > 3);
  await page.check('#pick-1');
  await page.check('#pick-2');
  await page.click('#compare-button');
  await page.waitForURL(/compare/);
  check('jobs can be compared', await page.locator('[data-metric=bending_angle_deg] td.number').count() === 2);
  check('and drawn', await page.locator('.wide-plot img').evaluate((image) => image.naturalWidth) === 1000);
  await visit.go('/?limit=1');
  await page.click('#older');
  await page.waitForURL(/cursor/);
  check('pages lead on', await page.locator('#jobs tr').count() === 1);
  await page.selectOption('#filter-state', 'failed,timed_out');
  await page.click('#filter button');
  await page.waitForURL(/state/);
  check('states can be chosen', await page.locator('#jobs tr').count() === 1);
  await visit.go('/jobs/1');
  check('a job has its metrics', Number(await page.textContent('[data-metric=bending_angle_deg] .number')) > 0);
  check('its samples', await page.locator('.samples tbody tr').count() === 5);
  check('its plots', await page.locator('img').count() >= 4);
  check('its files', await page.locator('#file-list a[href$="model.inp"]').count() === 1);
  check('commands', /curl -s .*\/api\/v1\/jobs\/1\/document/.test(await page.textContent('#commands')));
  check('and no button that needs scripts', await page.locator('.scripted:visible').count() === 0);
  await visit.quiet();
  await visit.shot('job-unscripted');
  await visit.close();
}

// A study is one row of the list, and can be read as a table.
async function testStudy({ open, check, daemon }) {
  const study = await daemon.submit({ kind: 'study', name: 'two gaps', sampling: 'grid', base: finger({ error_estimate: false }),
    parameters: [{ pointer: '/actuator/chamber_gap', values: ['1 mm', '1.5 mm'] }] });
  const visit = await open('/', { script: false });
  const { page } = visit;
  check('a study is one row', await page.locator('#jobs tr').first().getAttribute('data-id') === String(study.id));
  await page.click(`#jobs tr[data-id="${study.id}"] .name a`);
  await page.waitForURL(/studies/);
  check('its designs can be read', await page.locator('#reading-table tbody tr').count() === 2);
  const gaps = () => page.locator('#reading-table tbody td:nth-child(3)').allTextContents();
  check('with their dimensions', (await gaps()).join() === '1,1.500');
  for (const order of ['chamber_gap', '-chamber_gap']) {
    await page.click('#reading-table thead th:nth-child(3) a');
    await page.waitForURL((url) => url.search.endsWith(`sort=${order.startsWith('-') ? '-' : ''}/actuator/chamber_gap`));
  }
  check('links sort them', (await gaps()).join() === '1.500,1');
  check('and it is drawn', await page.locator('.plot img').count() > 0);
  await visit.quiet();
  await visit.close();
}

await lab(async (tools) => {
  const { daemon } = tools;
  await daemon.submit(finger());
  await daemon.submit(finger({ name: TRICK, actuator: { chamber_gap: '1 mm' } }));
  await daemon.submit(finger({ name: 'too much', error_estimate: false, load: { pressure: { to: '2 MPa', steps: 40 } } }));
  await testList(tools);
  await testCompare(tools);
  await testShape(tools);
  await testEditor(tools);
  await testRunning(tools);
  await testReading(tools);
  await testStudy(tools);
  await visitSizes(tools.open, { list: '/', job: '/jobs/1', failed: '/jobs/3', compare: '/compare?jobs=1,2', submit: '/submit?from=1' });
}, { options: ['--workers', '1'] });
