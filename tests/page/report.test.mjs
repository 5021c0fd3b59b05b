// The report of a run as its reader meets it: one file, opened from a disk, with no net; the run is looked at again in it.
//
// Needs ISOBATH_PROGRAM and ISOBATH_CHROMIUM; ISOBATH_SCREENSHOTS names a folder for pictures to be looked at.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { after, before, test } from 'node:test';
import { pathToFileURL } from 'node:url';

const { chromium } = createRequire(new URL('../../web/package.json', import.meta.url))('playwright-core');
const scratch = mkdtempSync(join(tmpdir(), 'isobath-report-'));
const patience = 60_000; // ms; what is waited for comes far sooner, and a loaded machine decides nothing

let browser;
let report;
before(async () => {
  const out = join(scratch, 'run');
  execFileSync(process.env.ISOBATH_PROGRAM, ['run', '--out', out], { stdio: ['ignore', 'ignore', 'inherit'] });
  report = join(out, 'report.html');
  const quiet = ['disable-background-networking', 'disable-component-update', 'disable-sync', 'no-first-run'];
  const args = ['--no-sandbox', '--disable-gpu', '--disable-quic', ...quiet.map((flag) => `--${flag}`)];
  browser = await chromium.launch({ executablePath: process.env.ISOBATH_CHROMIUM, args });
});
after(async () => {
  await browser?.close();
  rmSync(scratch, { recursive: true, force: true });
});

/** The report, and the page in it. */
async function open(width, height, options = {}) {
  const context = await browser.newContext({ viewport: { width, height }, ...options });
  await context.setOffline(true);
  const page = await context.newPage();
  page.setDefaultTimeout(patience);
  page.troubles = [];
  page.on('pageerror', (error) => page.troubles.push(String(error)));
  page.on('console', (message) => message.type() === 'error' && page.troubles.push(message.text()));
  page.on('request', (request) => {
    if (!/^(file|data|blob|about):/.test(request.url())) page.troubles.push(`asks for ${request.url()}`);
  });
  await page.goto(pathToFileURL(report).href);
  const frame = page.frames().find((f) => f !== page.mainFrame());
  return { page, frame, close: () => context.close() };
}

const now = async (frame) => Number(await frame.getAttribute('#timeline', 'aria-valuenow'));
const end = async (frame) => Number(await frame.getAttribute('#timeline', 'aria-valuemax'));
/** The run comes after what its kind of run is about; a browser draws no frame that is out of view. */
async function isShown(frame) {
  await (await frame.frameElement()).scrollIntoViewIfNeeded();
  await frame.waitForSelector('#connection[data-state="stored"]');
  await frame.waitForFunction(() => Number(document.querySelector('#timeline').getAttribute('aria-valuemax')) > 80);
}
/** How many colours a canvas shows: an empty one has one. */
const colours = (frame, selector) =>
  frame.$eval(selector, (canvas) => {
    const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    return new Set(new Uint32Array(data.buffer)).size;
  });
async function picture(page, name, whole = false) {
  if (process.env.ISOBATH_SCREENSHOTS) {
    await page.screenshot({ path: join(process.env.ISOBATH_SCREENSHOTS, `${name}.png`), fullPage: whole });
  }
}

// ledger: S5-59
test('a report shows its run again from a disk, from its end to its start and on', async () => {
  const { page, frame, close } = await open(1400, 900);
  await isShown(frame);
  assert.match(await frame.textContent('#connection'), /stored run/);
  assert.ok((await now(frame)) >= (await end(frame)) - 0.1, 'it begins with all that was found');
  assert.equal(await frame.getAttribute('#play', 'data-playing'), 'false', 'and stands');
  assert.ok((await colours(frame, '#plan-canvas')) > 20, 'the chart is drawn');
  const told = await frame.$$eval('#log-list li[data-decision]', (all) =>
    all.map((li) => [li.querySelector('.log-number').textContent, li.querySelector('.log-reason').textContent]),
  );
  const { decisions } = JSON.parse(readFileSync(join(dirname(report), 'decisions.json'), 'utf8'));
  assert.ok(decisions.length > 0, 'decisions are told');
  assert.deepEqual(
    told.reverse(),
    decisions.map(({ number, reason }) => [String(number), reason]),
    'by the numbers that they have everywhere',
  );
  await frame.click('#tab-obstacles');
  await frame.waitForSelector('#obstacle-list li'); // the list is drawn with the next frame
  const things = await frame.$$eval('#obstacle-list li', (all) => all.map((li) => Number(li.dataset.obstacle)));
  const { obstacles } = JSON.parse(readFileSync(join(dirname(report), 'obstacles.json'), 'utf8'));
  for (const { number } of obstacles) assert.ok(things.includes(number), `obstacle ${number} is in the list`);
  assert.equal(new Set(things).size, things.length, 'once each');
  await frame.click('#tab-log');
  await picture(page, 'report-1400');
  await picture(page, 'report-1400-whole', true);

  const figures = await frame.textContent('#instruments');
  await frame.click('#play');
  await frame.waitForFunction(() => {
    const at = Number(document.querySelector('#timeline').getAttribute('aria-valuenow'));
    return at > 1 && at < 60;
  });
  await frame.click('#play');
  await frame.waitForSelector('#play[data-playing="false"]');
  assert.notEqual(await frame.textContent('#instruments'), figures, 'it plays from its start');

  const strip = await frame.locator('#timeline').boundingBox();
  await page.mouse.click(strip.x + 0.5 * strip.width, strip.y + strip.height / 2);
  await frame.waitForFunction(() => {
    const at = Number(document.querySelector('#timeline').getAttribute('aria-valuenow'));
    return at > 50 && at < 65;
  });
  assert.ok((await colours(frame, '#sonar-canvas')) > 20, 'the sonar is drawn');
  await picture(page, 'report-1400-middle');
  await frame.click('#tab-space');
  await frame.waitForFunction(() => document.querySelector('#space-canvas').width > 100);
  await frame.click('#tab-health');
  await frame.waitForFunction(() => /pings/.test(document.querySelector('#health-counts').textContent));
  assert.equal(await frame.textContent('#malformed-count'), 'none');
  await picture(page, 'report-1400-space');
  assert.deepEqual(page.troubles, []);
  await close();
});

test('keys and wheel belong to the report until its reader has gone into the run', async () => {
  const { page, frame, close } = await open(1400, 900);
  await isShown(frame);
  const scale = () => frame.getAttribute('#plan-canvas', 'data-scale');
  const as_it_was = await scale();
  await page.keyboard.press('n');
  const box = await frame.locator('#plan-canvas').boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  const top = await page.evaluate(() => window.scrollY);
  await page.mouse.wheel(0, 300);
  await page.waitForFunction((was) => window.scrollY > was + 100, top);
  assert.equal(await scale(), as_it_was);
  assert.equal(await frame.getAttribute('html', 'data-theme'), 'day');
  await frame.locator('#plan-canvas').click(); // where it is by then: the report may still be gliding
  await frame.waitForFunction(() => document.hasFocus());
  await page.mouse.wheel(0, 300);
  await frame.waitForFunction((was) => document.querySelector('#plan-canvas').dataset.scale !== was, as_it_was);
  await page.keyboard.press('n');
  await frame.waitForSelector('html[data-theme="night"]');
  assert.deepEqual(page.troubles, []);
  await close();
});

test('on a phone by night the run has the layout of a phone', async () => {
  const { page, frame, close } = await open(390, 844, { colorScheme: 'dark', hasTouch: true, isMobile: true });
  await isShown(frame);
  assert.equal(await frame.getAttribute('html', 'data-theme'), 'night');
  assert.ok(await frame.isVisible('#tabs [data-show="log"]'));
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= window.innerWidth), 'nothing juts out');
  await picture(page, 'report-390');
  await picture(page, 'report-390-whole', true);
  await frame.tap('#tabs [data-show="log"]');
  await frame.waitForSelector('#log-list li[data-decision]');
  await picture(page, 'report-390-log');
  assert.deepEqual(page.troubles, []);
  await close();
});

test('without scripts, and in print, there is the written report alone', async () => {
  const { page, close } = await open(1400, 900, { javaScriptEnabled: false });
  assert.equal(await page.locator('iframe').isVisible(), false);
  assert.ok((await page.locator('figure img').count()) > 0);
  await picture(page, 'report-plain');
  await close();
  const printed = await open(1400, 900);
  await printed.page.emulateMedia({ media: 'print' });
  assert.equal(await printed.page.locator('iframe').isVisible(), false);
  await printed.close();
});

test('a report without its run is as small as what is written in it', () => {
  const out = join(scratch, 'plain');
  execFileSync(process.env.ISOBATH_PROGRAM, ['run', '--set', 'report.replay=false', '--out', out], { stdio: 'ignore' });
  const plain = readFileSync(join(out, 'report.html'), 'utf8');
  assert.ok(!plain.includes('<iframe') && !plain.includes('<script'));
});
