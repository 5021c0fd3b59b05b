// A group of vehicles on the live page: each vehicle has a page, and is commanded there.
import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { open, picture, scratch, serve, source, start, state, stop, until } from './program.mjs';

before(start);
after(stop);

const kToken = 'a token of thirty-two characters';
const scene = `
[scene]
duration_s = 400
[bottom]
kind = "flat"
depth = 25
extent_m = 200
[vehicle]
name = "alpha"
file = "${source('vehicles/remus100.toml')}"
dynamic = true
start = [-20, 10, 8]
speed = 1.5
[[group_vehicle]]
name = "bravo"
start = [-20, 60, 8]
[acoustic_link]
loss = 0
[navigation]
kind = "drift"
[[sonar]]
preset = "obstacle_cone"
[mission]
title = "Two pages"
[search_area]
length_m = 80
breadth_m = 80
spacing_m = 20
depth_m = 8
`;

// ledger: S2-50 S2-52
test('each vehicle of a group has a page, which leads to the others and commands its own', async () => {
  const file = join(scratch, 'group.toml');
  const token = join(scratch, 'token');
  writeFileSync(file, scene);
  writeFileSync(token, kToken);
  const program = await serve('group', file, '--port', '0', '--speed', '4', '--token-file', token);
  const alpha = await open(program.url);
  await state(alpha, 'open');
  await alpha.waitForSelector('#group a');
  assert.deepEqual(await alpha.$$eval('#group a', (all) => all.map((a) => a.textContent)), ['alpha', 'bravo']);
  assert.equal(await alpha.textContent('#group a[aria-current="page"]'), 'alpha');
  const bravo = await open(new URL(await alpha.getAttribute('#group a:not([aria-current])', 'href'), program.url).href);
  await state(bravo, 'open');
  await bravo.waitForSelector('#group a[aria-current="page"]');
  assert.equal(await bravo.textContent('#group a[aria-current="page"]'), 'bravo');
  await until(bravo, 12);
  assert.notEqual(await bravo.textContent('#now-position'), '');
  assert.equal(await bravo.isVisible('label.layer:has(#layer-partners)'), false, 'alpha has not been heard yet');
  await until(bravo, 25);
  await bravo.waitForSelector('label.layer:has(#layer-partners):not([hidden])', { state: 'attached' });
  await bravo.click('#tab-health');
  await bravo.fill('#command-token', kToken);
  await bravo.click('#command-form button');
  await bravo.click('#command-hold');
  await bravo.waitForSelector('#command-bar[data-phase="holding"]');
  await alpha.click('#tab-health');
  await alpha.waitForSelector('#health-levels');
  assert.doesNotMatch(await alpha.textContent('#health-levels'), /hold/, 'the other vehicle goes on');
  assert.match(await bravo.textContent('#health-levels'), /hold/);
  assert.match(await alpha.textContent('[data-level="mission"]'), /plans \d+ s ahead/);
  assert.match(await alpha.textContent('[data-level="vehicle"]'), /plans \d+ s ahead; at "lane 1, station \d \(point \d+\)" \(node \d+ of \d+\); next /);
  await picture(bravo, 'group-1400');
  await picture(alpha, 'group-alpha-1400');
  assert.deepEqual([...alpha.troubles, ...bravo.troubles], []);
  assert.equal(await program.end(), 0);
});
