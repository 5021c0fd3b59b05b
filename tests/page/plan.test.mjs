// A mission is planned on the chart, its way is shown before it is sent, and the vehicle sails it; one page has command.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { open, picture, scratch, serve, source, start, stop } from './program.mjs';

before(start);
after(stop);

const token = 'what only the skipper knows';
const axe = readFileSync(source('web/node_modules/axe-core/axe.min.js'), 'utf8');

/** Open water with a pile beside the way to the north-east. */
const scene = `
[scene]
duration_s = 3000
[bottom]
kind = 'flat'
material = 'mud'
depth = 30
extent_m = 400
[vehicle]
start = [0, 0, 15]
speed = 1
[navigation]
kind = 'drift'
[mission]
speed = 0.3
[geofence]
corners = [[-60, -100], [400, -100], [400, 100], [-60, 100]]
[[mission_point]]
north = 380
east = 0
depth_m = 15
[[cylinder]]
centre = [32, 18, 15]
radius = 0.5
length = 30
[[sonar]]
preset = 'oculus_m750d'
range_m = 60
bins = 100
interval_s = 0.5
`;

/** Where a place is on the chart, which is north up, once it has been drawn anew. */
async function pixel(page, north, east) {
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  const canvas = page.locator('#plan-canvas');
  const box = await canvas.boundingBox();
  const told = await canvas.evaluate(({ dataset }) => [dataset.north, dataset.east, dataset.scale].map(Number));
  return [box.x + box.width / 2 + (east - told[1]) / told[2], box.y + box.height / 2 - (north - told[0]) / told[2]];
}
/** That it is told of its rights; how old its content is depends on the machine. */
const connected = (page) => page.waitForSelector('#commands:not([hidden])', { state: 'attached' });
const checked = (page) => page.waitForSelector('#draft[data-checked="true"]');
const rows = (page, count) =>
  page.waitForFunction((wanted) => document.querySelectorAll('#draft-list li').length === wanted, count);
const decided = (page, ...what) =>
  page.waitForFunction(
    (words) =>
      [...document.querySelectorAll('#log-list li[data-decision]')].some((li) =>
        words.every((word) => li.textContent.includes(word)),
      ),
    what,
    { timeout: 240_000 },
  );
async function take(page, health) {
  await page.click(health);
  await page.fill('#command-token', token);
  await page.click('#command-form button');
  await page.waitForSelector('#command-bar:not([hidden])');
}
async function findings(page) {
  await page.evaluate(axe);
  const { violations } = await page.evaluate(() =>
    window.axe.run(document, {
      runOnly: ['wcag2a', 'wcag2aa', 'wcag21aa', 'wcag22aa', 'best-practice'],
      rules: { 'color-contrast': { enabled: false } }, // a page that is behind dims its instruments; accessibility.test looks
    }),
  );
  return violations.flatMap(({ id, nodes }) => nodes.map(({ target }) => `${id}: ${target.join(' ')}`));
}

test('a mission is planned with the mouse, previewed with its margins, sent and sailed; another page sees who commands', async () => {
  const file = join(scratch, 'token');
  writeFileSync(file, `${token}\n`);
  const water = join(scratch, 'water.toml');
  writeFileSync(water, scene);
  const program = await serve('planned', water, '--port', '0', '--speed', '4', '--token-file', file);
  const page = await open(program.url);
  await connected(page);
  assert.equal(await page.isVisible('#plan-mission'), false, 'without command nothing is planned');
  await take(page, '#tab-health');
  await page.waitForSelector('#command-bar[data-phase="under way"]');
  await page.click('#tab-log');
  await decided(page, 'captain', 'command', 'the page at 127.0.0.1 has command');

  const other = await open(program.url, 390, 844, 'dark', true);
  await connected(other);
  await other.waitForSelector('#commander-bar:not([hidden])');
  assert.match(await other.textContent('#commander'), /^The page at 127\.0\.0\.1 has command since \d/);
  assert.equal(await other.isVisible('#command-bar'), false);
  await picture(other, 'plan-commander-390');

  // The pile must be known before its margin can be.
  await page.waitForFunction(() => document.querySelector('#plan-canvas').dataset.obstacles, null, { timeout: 120_000 });
  await page.click('#plan-mission');
  await rows(page, 1);
  await checked(page);
  assert.match(await page.textContent('#draft-state'), /^1 point, [\d.]+ m; .*[\d.]+ m in water that no map knows/);
  await picture(page, 'plan-mission-1400');

  // A fence that leaves the point outside is refused before anything is sent.
  await page.fill('#draft-row-0-north', '500');
  await page.press('#draft-row-0-north', 'Enter');
  await page.waitForFunction(() => /outside the fence/.test(document.querySelector('#draft-state').textContent));
  assert.ok(await page.isDisabled('#draft-send'));
  await picture(page, 'plan-refused-1400');
  await page.click('#draft-undo');
  await checked(page);

  await page.focus('#draft-row-0-pick');
  await page.click('#draft-row-0-pick');
  await page.keyboard.press('Delete');
  await rows(page, 0);
  for (let i = 0; i < 2; ++i) await page.click('#plan-in');
  await page.mouse.click(...(await pixel(page, 60, 20)));
  await rows(page, 1);
  await page.mouse.click(...(await pixel(page, 50, -20)));
  await rows(page, 2);
  await page.mouse.move(...(await pixel(page, 50, -20)));
  await page.mouse.down();
  await page.mouse.move(...(await pixel(page, 65, -20)), { steps: 5 });
  await page.mouse.up();
  const north = Number(await page.inputValue('#draft-row-1-north'));
  assert.ok(Math.abs(north - 65) < 3, `the point was moved to ${north} m`);
  await page.fill('#draft-row-1-down', '12');
  await page.press('#draft-row-1-down', 'Enter');
  for (const row of [0, 1]) {
    await page.fill(`#draft-row-${row}-speed`, '1');
    await page.press(`#draft-row-${row}-speed`, 'Enter');
  }
  await checked(page);
  await page.waitForFunction(() => /margin [\d.]+ m to/.test(document.querySelector('#draft-list').textContent));
  assert.match(await page.textContent('#draft-state'), /^2 points, [\d.]+ m; least margin [\d.]+ m/);
  assert.deepEqual(await findings(page), []);
  await picture(page, 'plan-previewed-1400');

  await page.click('#draft-send');
  await page.waitForSelector('#draft', { state: 'hidden' });
  await decided(page, 'captain', 'new mission', '2 points, sent by the page at 127.0.0.1');
  await picture(page, 'plan-sent-1400');
  await page.click('#command-hold');
  await page.waitForSelector('#command-bar[data-phase="holding"]');

  // The other page takes over, and sends the vehicle to a place that it presses.
  await take(other, '#tabs [data-show="health"]');
  await page.waitForSelector('#command-bar', { state: 'hidden' });
  assert.match(await page.textContent('#toast'), /has lost command/);
  await page.waitForSelector('#commander-bar:not([hidden])');
  await decided(page, 'captain', 'takes over from the page at 127.0.0.1');
  await other.click('#tabs [data-show="plan"]');
  await other.click('#plan-fit');
  await other.touchscreen.tap(...(await pixel(other, 0, 20)));
  await other.waitForSelector('#plan-go:not([hidden])'); // which lies under the finger, and is not pressed by this tap
  await picture(other, 'plan-go-390');
  await other.click('#plan-go');
  await rows(other, 1);
  await checked(other);
  assert.deepEqual(await findings(other), []);
  for (const button of await other.locator('#draft button:visible').all()) {
    const { width, height } = await button.boundingBox();
    assert.ok(width >= 24 && height >= 24, `${await button.textContent()} is ${width} x ${height} px`);
  }
  await picture(other, 'plan-draft-390');
  await other.click('#draft-discard');
  await other.waitForSelector('#draft', { state: 'hidden' });

  // The vehicle sails the mission that was sent.
  await other.click('#command-resume');
  await decided(page, 'captain', 'finished', '2 of 2 points reached');
  assert.deepEqual([...page.troubles, ...other.troubles], []);
  await page.close();
  await other.close();
  await program.end();
});

test('the vehicle returns to where it started when it is told to', async () => {
  const file = join(scratch, 'token');
  writeFileSync(file, `${token}\n`);
  const water = join(scratch, 'return.toml');
  writeFileSync(water, scene);
  const program = await serve('returned', water, '--port', '0', '--speed', '8', '--token-file', file);
  const page = await open(program.url);
  await connected(page);
  await take(page, '#tab-health');
  await page.click('#tab-log');
  await page.waitForSelector('#command-return:not([disabled])');
  await page.click('#command-return');
  assert.match(await page.textContent('#command-return'), /again/);
  await page.click('#command-return');
  await decided(page, 'captain', 'new mission', '1 point, sent by the page at 127.0.0.1');
  await decided(page, 'captain', 'finished', '1 of 1 points reached');
  assert.deepEqual(page.troubles, []);
  await page.close();
  await program.end();
});
