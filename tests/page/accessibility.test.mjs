// The page for those who hear it, who see little, who press keys by other means, and on paper; and its alarms.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, before, test } from 'node:test';
import { open, picture, serve, source, start, state, stop } from './program.mjs';

before(start);
after(stop);

const axe = readFileSync(source('web/node_modules/axe-core/axe.min.js'), 'utf8');
const views = ['plan', 'space', 'obstacles', 'health', 'log', 'plots'];

/** What axe-core finds, in each of these views. */
async function findings(page, views) {
  await page.evaluate(axe);
  const found = new Set();
  for (const view of views) {
    const button = page.locator(`[data-show="${view}"]:visible`).first();
    if (await button.count()) await button.click();
    const { violations } = await page.evaluate(() =>
      window.axe.run(document, { runOnly: ['wcag2a', 'wcag2aa', 'wcag21aa', 'wcag22aa', 'best-practice'] }),
    );
    for (const { id, nodes } of violations) for (const { target } of nodes) found.add(`${id}: ${target.join(' ')}`);
  }
  return [...found];
}

test('axe-core finds nothing, by day and by night, on a desk, on a phone and magnified; an alarm calls', async () => {
  const program = await serve('leak', source('scenarios/faults/leak.toml'), '--port', '0', '--speed', '2');
  const page = await open('about:blank');
  await page.addInitScript(() => {
    window.tones = 0;
    const silent = { connect: (to) => to, start() {}, stop() {}, frequency: {}, gain: {} };
    window.AudioContext = class {
      state = 'running';
      currentTime = 0;
      resume() {}
      createOscillator() {
        ++window.tones;
        return silent;
      }
      createGain() {
        return silent;
      }
    };
  });
  await page.goto(program.url);
  await state(page, 'open');
  await page.waitForFunction(() => /^▲ /.test(document.title));
  await page.waitForFunction(() => /leak/.test(document.querySelector('#alarm-text').textContent));
  await page.waitForFunction(() => window.tones >= 2);
  await page.waitForFunction(() => /WATER/.test(document.querySelector('#now-leak').textContent));
  assert.match(await page.textContent('#now-attitude'), /(even|stb|port), (level|up|down)|°/);
  await picture(page, 'alarm-banner-1400');
  await page.click('#alarm-seen');
  await page.waitForFunction(() => !/▲/.test(document.title));
  assert.ok(await page.isVisible('#alarm-text'), 'the alarm is shown until it is over');
  await page.waitForFunction(() => document.querySelector('#announce').textContent !== '');

  await page.click('#help-button');
  await page.click('#keys-on');
  await page.click('#help-close');
  await page.keyboard.press('n');
  assert.equal(await page.getAttribute('html', 'data-theme'), 'day', 'single keys are switched off');

  await page.emulateMedia({ media: 'print' });
  assert.equal(await page.isVisible('.transport'), false);
  assert.ok(await page.isVisible('#log-list'));
  await page.emulateMedia({ media: 'screen', forcedColors: 'active' });
  await page.waitForFunction(() => document.querySelector('#timeline-canvas').width > 500);
  await picture(page, 'forced-colours-1400');
  await page.emulateMedia({ forcedColors: 'none' });
  assert.deepEqual(await findings(page, views), []);
  for (const [width, height, theme] of [[1400, 900, 'night'], [390, 844, 'day'], [844, 390, 'night'], [320, 256, 'day']]) {
    await page.setViewportSize({ width, height });
    if ((await page.getAttribute('html', 'data-theme')) !== theme) await page.click('#theme');
    assert.deepEqual(await findings(page, ['health', 'plan']), [], `${width} x ${height}, ${theme}`);
    assert.ok(await page.isVisible('#now-heading'), 'instruments are there');
    const chart = await page.locator('#plan-canvas').boundingBox();
    assert.ok(chart.height > 100, `the chart is ${chart.height} px high`);
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= window.innerWidth), 'nothing juts out');
    await picture(page, `view-${width}-${theme}`);
  }
  assert.deepEqual(page.troubles, []);
  await page.close();
  await program.end();
});
