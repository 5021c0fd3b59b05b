// What an operator must be able to trust and to take along: what is shown, in which time, of which run.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, before, test } from 'node:test';
import { now, open, picture, serve, source, start, state, stop, until } from './program.mjs';

before(start);
after(stop);

const text = (page, id) => page.textContent(id);
const shows = (page, what) => page.waitForSelector(`body[data-shows="${what}"]`);
const colours = (page, selector) =>
  page.$eval(selector, (canvas) => {
    const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    return new Set(new Uint32Array(data.buffer)).size;
  });
async function saved(page, button) {
  await page.click('#plan-save');
  const [download] = await Promise.all([page.waitForEvent('download'), page.click(button)]);
  return { name: download.suggestedFilename(), bytes: readFileSync(await download.path()) };
}

test('present and past are told apart, keys stay where they are, and what is shown is saved', async () => {
  const program = await serve('operator', '--port', '0', '--speed', '1', '--limit', 'max_clients=2');
  const page = await open(program.url);
  await state(page, 'open');
  await shows(page, 'live');
  assert.match(await text(page, '#connection'), /LIVE simulation/);
  assert.equal(await page.inputValue('#speed'), '1', 'the speed of the run');
  assert.ok(await page.isDisabled('#speed'));
  await until(page, 14);
  await page.waitForSelector('#sonar-none', { state: 'hidden' });
  assert.ok((await colours(page, '#sonar-canvas')) > 5);

  await page.focus('#tab-log');
  await page.keyboard.press('ArrowRight');
  assert.equal(await page.getAttribute('#tab-obstacles', 'aria-selected'), 'true');
  assert.equal(await page.getAttribute('#live', 'aria-pressed'), 'true', 'an arrow key on a tab does not seek');

  await page.focus('#timeline');
  await page.keyboard.press('Home');
  await shows(page, 'past');
  await page.keyboard.press(' ');
  await page.keyboard.press('Home');
  await page.waitForSelector('#sonar-none:not([hidden])');
  assert.equal(await colours(page, '#sonar-canvas'), 1, 'no fan of a later time stays');
  assert.match(await text(page, '#connection'), /PAST −\d/);
  assert.equal(await text(page, '#live'), 'Go live');
  await picture(page, 'past-begin-1400');

  await page.keyboard.press('l');
  await shows(page, 'live');
  await until(page, (await now(page)) + 5);
  const [at, end] = await page.$eval('#timeline', (e) => ['now', 'max'].map((n) => Number(e.getAttribute(`aria-value${n}`))));
  assert.ok(at <= end, `the clock shows ${at} s of ${end} s`);

  // A layer that a skipper steers by does not stay hidden without a sign.
  await page.click('#plan-legend');
  await page.click('#layer-obstacles');
  await page.reload();
  await state(page, 'open');
  await page.waitForSelector('#plan-hidden:not([hidden])');
  assert.match(await text(page, '#plan-hidden'), /Hidden: obstacles/);
  await picture(page, 'hidden-layer-1400');
  await page.click('#plan-hidden');
  await page.waitForSelector('#plan-hidden', { state: 'hidden' });

  // What the chart draws is in words, too.
  await page.click('#tab-obstacles');
  await page.waitForFunction(() => document.querySelector('#obstacle-count').textContent !== '');
  await page.click('#obstacle-as-table');
  await page.waitForFunction(() => document.querySelectorAll('#obstacle-table tbody tr').length > 0);
  assert.match(await page.textContent('#obstacle-table thead'), /number.*kind.*extent m/);
  await picture(page, 'obstacle-table-1400');

  const chart = await saved(page, '#save-png');
  assert.match(chart.name, /chart\.png$/);
  assert.equal(chart.bytes.subarray(1, 4).toString(), 'PNG');
  const track = (await saved(page, '#save-track')).bytes.toString().trim().split('\n');
  assert.match(track[0], /^time_s,north_m,east_m,depth_m/);
  assert.ok(track.length > 10 && track.every((row) => row.split(',').length === track[0].split(',').length));
  assert.match((await saved(page, '#save-obstacles')).bytes.toString(), /^number,kind,extent_m/);

  await page.click('#plan-save');
  if (await page.isEnabled('#save-geojson')) {
    await page.click('#save-close');
    const json = JSON.parse((await saved(page, '#save-geojson')).bytes.toString());
    assert.ok(json.features.some(({ properties }) => properties.what === 'mission point'));
    await page.click('#plan-save');
  }
  await page.click('#save-link');
  assert.match(page.url(), /#t=[\d.]+&n=.*&e=.*&s=/);
  const moment = Number(/t=([\d.]+)/.exec(page.url())[1]);
  await until(page, moment + 10);
  const other = await open(page.url());
  await shows(other, 'past');
  await other.keyboard.press(' ');
  assert.ok(Math.abs((await now(other)) - moment) < 15, 'a link leads to its moment');

  const third = await open(program.url);
  await third.waitForFunction(() => /as many pages as it may/.test(document.querySelector('#notice').textContent));
  assert.match(await text(third, '#connection'), /no place left/);
  await picture(third, 'full-1400');
  assert.deepEqual([...page.troubles, ...other.troubles], []);
  for (const one of [page, other, third]) await one.close();
  await program.end();
});

test('without a mission the chart shows as far as the sonar looks', async () => {
  const program = await serve('tank', source('scenarios/tank.toml'), '--port', '0', '--speed', '4');
  const page = await open(program.url);
  await state(page, 'open');
  await page.waitForFunction(() => document.querySelector('#sonar-canvas').dataset.sonar);
  await until(page, (await now(page)) + 2);
  const high = await page.$eval('#plan-canvas', (c) => c.clientHeight * Number(c.dataset.scale));
  assert.ok(high > 4 && high < 80, `the chart is ${high} m high`);
  await picture(page, 'tank-1400');
  await page.close();
  await program.end();
});
