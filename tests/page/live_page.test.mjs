// The live page as its users meet it: the program serves, a real browser looks.
import assert from 'node:assert/strict';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { now, open, picture, scratch, serve, source, start, state, stop, until } from './program.mjs';

before(start);
after(stop);

const count = (page, name) =>
  page.evaluate((wanted) => {
    const term = [...document.querySelectorAll('#health-counts *')].find((e) => e.textContent.trim() === wanted);
    return Number((term?.nextElementSibling?.textContent ?? 'NaN').replaceAll(/[^0-9]/g, ''));
  }, name);

// ledger: S5-59
test('a simulated mission is seen as it runs, its past as it was, and by two pages alike', async () => {
  const program = await serve('pandan', '--port', '0', '--speed', '8');
  const page = await open(program.url);
  await state(page, 'open');
  await until(page, 12);
  assert.match(await page.textContent('#connection'), /live/);
  assert.notEqual(await page.textContent('#title'), '');
  await page.click('#tab-health');
  await page.waitForFunction(() => /pings/.test(document.querySelector('#health-counts').textContent));
  const pings = await count(page, 'pings');
  assert.ok(pings > 0, 'pings are counted');
  await until(page, (await now(page)) + 10);
  assert.ok((await count(page, 'pings')) > pings, 'the map goes on growing');
  await page.click('#tab-log');
  await page.waitForSelector('#log-list li[data-decision]');
  await picture(page, 'live-1400');

  await until(page, 60);
  const position = await page.textContent('#now-position');
  const strip = await page.locator('#timeline').boundingBox();
  await page.mouse.click(strip.x + 0.3 * strip.width, strip.y + strip.height / 2);
  await page.waitForSelector('#live[aria-pressed="false"]');
  await page.click('#play');
  await page.waitForSelector('#play[data-playing="false"]');
  const past = await now(page);
  assert.ok(past < 45, `the past is shown, not ${past} s`);
  assert.notEqual(await page.textContent('#now-position'), position);
  for (let i = 0; i < 3; ++i) await page.click('#step-forward'); // a step may be shorter than what is told of it
  await page.waitForFunction(
    (s) => Number(document.querySelector('#timeline').getAttribute('aria-valuenow')) > s,
    past,
  );
  await picture(page, 'past-1400');
  await page.click('#live');
  await page.waitForSelector('#live[aria-pressed="true"]');

  const other = await open(program.url, 390, 844, 'dark');
  await state(other, 'open');
  await other.waitForSelector('#live[aria-pressed="true"]');
  const decisions = (p) => p.$$eval('#log-list li[data-decision]', (all) => all.map((li) => li.textContent));
  await until(other, 30);
  await picture(other, 'phone-390');
  await other.click('#tabs [data-show="log"]');
  await other.waitForSelector('#log-list li[data-decision]');
  const seen = await decisions(page);
  const same = await decisions(other);
  const shorter = Math.min(seen.length, same.length);
  assert.ok(shorter > 0);
  assert.deepEqual(seen.slice(-shorter), same.slice(-shorter), 'both pages tell the same decisions');
  assert.deepEqual([...page.troubles, ...other.troubles], []);
  assert.equal(await page.textContent('#malformed-count'), 'none');
  await page.close();
  await other.close();
  assert.equal(await program.end(), 0);
});

test('a fault appears in the panel and in the banner', async () => {
  const program = await serve('fault', source('scenarios/faults/sonar_silent.toml'), '--port', '0', '--speed', '8');
  const page = await open(program.url);
  await state(page, 'open');
  await page.click('#tab-health');
  await page.waitForSelector('[data-trouble][data-active="true"]');
  assert.match(await page.textContent('#health-troubles'), /sonar silent/);
  assert.match(await page.textContent('#alarms'), /sonar silent/);
  await picture(page, 'fault-1400');
  assert.deepEqual(page.troubles, []);
  await page.close();
  await program.end();
});

test('a broken connection says so, and recovers by itself', async () => {
  let program = await serve('first', '--port', '0', '--speed', '4');
  const page = await open(program.url);
  await state(page, 'open');
  await until(page, 2);
  await program.end('SIGKILL');
  await page.waitForSelector('#notice:not([hidden])');
  assert.match(await page.textContent('#notice'), /old|lost|again/);
  await picture(page, 'lost-1400');
  program = await serve('second', '--port', program.port, '--speed', '4');
  await state(page, 'open');
  await page.waitForSelector('#notice', { state: 'hidden' });
  await page.close();
  await program.end();
});

// Threads of their own sense, map, decide, steer and show; the mission is as long as it takes.
// ledger: S5-59 S6-31
test('a mission with real threads is seen as it runs, its past as it was, and ends as it should', async () => {
  const mission = source('scenarios/simulated_mission_1.toml');
  const program = await serve('real-threads', mission, '--live', '--port', '0', '--speed', '4');
  assert.match(program.said(), /live, speed 4/);
  const page = await open(program.url);
  await state(page, 'open');
  await until(page, 20);
  assert.match(await page.textContent('#connection'), /live/);
  await page.waitForSelector('#log-list li[data-decision]');
  await page.click('#tab-health');
  await page.waitForFunction(() => /pings/.test(document.querySelector('#health-counts').textContent));
  assert.ok((await count(page, 'pings')) > 0, 'pings are counted');
  assert.equal(await count(page, 'events and messages not shown'), 0);
  await picture(page, 'real-threads-health-1400');
  await page.click('#tab-log');
  await until(page, 45);
  await picture(page, 'real-threads-1400');

  const position = await page.textContent('#now-position');
  const strip = await page.locator('#timeline').boundingBox();
  await page.mouse.click(strip.x + 0.3 * strip.width, strip.y + strip.height / 2);
  await page.waitForSelector('#live[aria-pressed="false"]');
  await page.waitForFunction(
    (shown) => document.querySelector('#now-position').textContent !== shown,
    position,
  );
  await picture(page, 'real-threads-past-1400');
  await page.click('#live');
  await page.waitForSelector('#live[aria-pressed="true"]');
  await page.waitForFunction(() => /finished/.test(document.querySelector('#instruments').textContent));
  await picture(page, 'real-threads-end-1400');
  assert.deepEqual(page.troubles, []);
  await page.close();
  assert.equal(await program.end(), 0);
  assert.match(program.said(), /Mission finished: 3 of 3 points reached/);
});

test('a recording is scrubbed, decision by decision', async () => {
  const first = await serve('taped', '--port', '0', '--speed', 'max', '--set', 'simulation.duration_s=40');
  await new Promise((resolve) => {
    const wait = setInterval(() => {
      if (!/written to/.test(first.said())) return;
      clearInterval(wait);
      resolve();
    }, 50);
  });
  await first.end();
  const program = await serve('replay', join(scratch, 'taped', 'recording.mcap'), '--port', '0');
  const page = await open(program.url);
  await state(page, 'open');
  await page.waitForFunction(() => Number(document.querySelector('#timeline').getAttribute('aria-valuemax')) > 35);
  assert.ok((await now(page)) < 30, 'a recording begins at its start');
  assert.equal(await page.isVisible('#live'), false, 'a recording has no now to go to');
  await page.keyboard.press('l');
  const strip = await page.locator('#timeline').boundingBox();
  await page.mouse.click(strip.x + 0.9 * strip.width, strip.y + strip.height / 2);
  await until(page, 30);
  await page.mouse.click(strip.x + 0.1 * strip.width, strip.y + strip.height / 2);
  await page.waitForFunction(() => Number(document.querySelector('#timeline').getAttribute('aria-valuenow')) < 15);
  assert.equal(await page.isVisible('#toast'), false, 'nothing was refused');
  assert.deepEqual(page.troubles, []);
  await page.close();
  await program.end();
});
