// The page of a grasp: the moving view of fingers and object, what can be read without scripts, the
// comparison of grasps.
import { BY_SOFTWARE, visitSizes } from './browser.mjs';
import { lab } from './driver.mjs';

// A short finger that presses on a bar, which is drawn from under it.
function grasp(name, friction) {
  return {
    kind: 'grasp',
    name,
    actuator: {
      family: 'pneunet', length: '38 mm', width: '20 mm', height: '15.6 mm', chambers: [{ config: 'B', count: 4 }],
      chamber_gap: '2 mm', side_wall: '2 mm', top_wall: '1.5 mm', bottom_layer: '4 mm',
    },
    material: 'dragon-skin-30',
    load: { pressure: { to: '25 kPa', steps: 3 } },
    object: {
      shape: { form: 'cylinder', diameter: '20 mm', length: '40 mm' },
      position: ['28 mm', 0, '-11 mm'], axis: [0, 1, 0], friction,
    },
    grasp: { pull: { direction: [1, 0, 0], distance: '3 mm', steps: 6 } },
    accuracy: 'draft',
  };
}

async function testView({ open, check }) {
  const visit = await open('/jobs/1');
  const { page } = visit;
  await visit.until('the grasp is drawn', () => document.getElementById('shape-canvas')?.dataset.drawn > 0);
  const canvas = page.locator('#shape-canvas');
  await canvas.scrollIntoViewIfNeeded();
  const seen = [await canvas.screenshot()];
  const differs = async (name, act) => {
    await act();
    await page.waitForTimeout(250);
    const picture = await canvas.screenshot();
    check(name, seen.every((one) => !one.equals(picture)));
    seen.push(picture);
  };
  check('it starts at the peak', /^Pull · .*kPa · .*mm · .*N/.test(await page.textContent('#shape-value')));
  check('the legend has its unit', await page.textContent('#shape-legend .legend-title') === 'Contact pressure (kPa)');
  await differs('the slider moves it', () => page.fill('#shape-pressure', '0'));
  await page.focus('#shape-pressure');
  await differs('keys move it on', async () => {
    for (let i = 0; i < 8; i++) {
      await page.keyboard.press('PageUp');
    }
  });
  check('readers of screens are told', /^Gripper and object: .*coloured by contact pressure from 0\skPa to/.test(
    await canvas.getAttribute('aria-label')));
  await differs('the object can be hidden', () => page.uncheck('#shape-ghost'));
  await differs('a moment is gone to', () => page.click('.shape-tools button:text-is("Last touch")'));
  await differs('colours change', () => page.selectOption('#shape-field', 'stretch'));
  await page.click('.shape-tools button:text-is("Before")');
  await visit.until('the address says what is seen', () => location.hash === '#shape=0,stretch');
  await page.click('.shape-tools button:text-is("Play")');
  await visit.until('it plays to its end', () => document.getElementById('shape-pressure').value === '1000');
  await visit.accessible('the grasp is accessible');
  await visit.still();
  await visit.quiet('the view complains about nothing', BY_SOFTWARE);
  await visit.close();
}

async function testReading({ open, check }) {
  const visit = await open('/jobs/1', { script: false });
  const { page } = visit;
  check('a picture stands for the view', await page.locator('#shape img').evaluate((image) => image.naturalWidth) === 800);
  check('the peak has its unit', await page.textContent('[data-metric=grasp_force_peak_N] .unit') === 'N');
  check('stages can be read', /pull/.test(await page.textContent('.samples tbody')));
  for (const plot of ['force', 'snapshots', 'contact', 'stages']) {
    check(`${plot} is drawn`, await page.locator(`[data-plot=${plot}] img`).evaluate(async (image) => {
      await image.decode();
      return image.naturalWidth;
    }) === 800);
  }
  await visit.quiet();
  await visit.close();
}

// The picture that stands for the chart without scripts.
async function testCompareReading({ open, check }) {
  const visit = await open('/compare?jobs=1,2', { script: false });
  const picture = visit.page.locator('#curves img');
  check('the picture is one of forces', await picture.getAttribute('alt') === 'Forces of the grasps against displacement');
  check('it is drawn', await picture.evaluate(async (image) => {
    await image.decode();
    return image.naturalWidth > 800;
  }));
  await visit.quiet();
  await visit.close();
}

async function testCompare({ open, check }) {
  const visit = await open('/?compare=1,2');
  await visit.page.click('#compare-button');
  await visit.until('the forces are drawn', () => document.querySelector('#curve-chart canvas'));
  check('over the displacement', /^Grasp force \(N\) against displacement of the object of 2 jobs/.test(
    await visit.page.getAttribute('#curve-chart', 'aria-label')));
  const rows = await visit.page.locator('#compare-table tr[data-metric]').evaluateAll((all) => all.map((row) =>
    [row.dataset.metric, [...row.querySelectorAll('td.number')].map((cell) => parseFloat(cell.textContent))]));
  const values = Object.fromEntries(rows);
  check('forces come first', rows.slice(0, 2).map(([name]) => name).join() === 'grasp_force_peak_N,grasp_force_mean_N');
  for (const name of ['grasp_force_peak_N', 'grasp_force_mean_N', 'normal_force_N', 'contact_area_mm2', 'slip_onset_mm']) {
    check(`${name} of both`, values[name]?.length === 2 && values[name].every((value) => value > 0));
  }
  const [rough, smooth] = values.grasp_force_peak_N;
  check('more friction holds better', rough > 1.2 * smooth);
  check('by how much is said', /^−\d+\.\d\s%$/.test(
    await visit.page.textContent('tr[data-metric=grasp_force_peak_N] .difference')));
  check('so is what they differ in', /0\.9.*0\.4/.test(
    await visit.page.textContent('tr[data-pointer="/object/friction"]')));
  await visit.page.selectOption('#curve-key', 'contact_area_mm2');
  check('other quantities can be drawn', /^Contact area \(mm²\) against displacement/.test(
    await visit.page.getAttribute('#curve-chart', 'aria-label')));
  check('grasps are side by side', await visit.page.locator('.small-plot img').count() === 2);
  await visit.accessible('the comparison is accessible');
  await visit.quiet('the comparison complains about nothing', BY_SOFTWARE);
  await visit.close();
}

async function testExample({ open, check }) {
  const visit = await open('/submit');
  await visit.page.click('#example-grasp');
  await visit.until('the example is valid', () => /grasp.*is valid/.test(document.querySelector('#verdict .answer')?.textContent));
  check('its fields are there', await visit.page.inputValue('[data-pointer="/actuator/chamber_gap"]') === '2 mm');
  await visit.accessible('the form is accessible');
  await visit.quiet('the form complains about nothing', /4(00|22)/);
  await visit.close();
}

await lab(async (tools) => {
  const { daemon, check } = tools;
  for (const [name, friction] of [['a rough bar', 0.9], ['a smooth bar', 0.4]]) {
    const job = await daemon.submit(grasp(name, friction));
    check(`${name}: it is solved`, job.state === 'succeeded', job.message);
  }
  await testView(tools);
  await testReading(tools);
  await testCompare(tools);
  await testCompareReading(tools);
  await testExample(tools);
  await visitSizes(tools.open, { grasp: '/jobs/1', compared: '/compare?jobs=1,2' });
}, { options: ['--workers', '1'] });
