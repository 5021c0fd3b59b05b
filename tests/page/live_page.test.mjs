// The live page as its users meet it: the program serves, a real browser looks.
import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
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
  const program = await serve('pandan', '--port', '0', '--speed', '4');
  const page = await open(program.url);
  await state(page, 'open');
  await until(page, 12);
  assert.match(await page.textContent('#connection'), /LIVE simulation/);
  const service = await (await fetch(new URL('register_service', program.url))).json();
  assert.equal(service.name, 'Isobath', 'BlueOS finds it');
  const { widgets } = await (await fetch(new URL(service.extras.cockpit, program.url))).json();
  assert.equal(widgets[0].iframe_url, '/');
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
  // A press on a row counts, though the list is told anew many times before the button comes up.
  await page.click('#tab-obstacles');
  const row = page.locator('#obstacle-list li[data-obstacle]').first();
  await row.hover();
  await page.mouse.down();
  const listed = () => page.$$eval('#obstacle-list li', (all) => all.map((li) => li.dataset.row).join());
  const [told, rows] = [await page.textContent('#obstacle-list'), await listed()];
  await until(page, (await now(page)) + 15);
  assert.notEqual(await page.textContent('#obstacle-list'), told, 'distances are told anew');
  assert.equal(await listed(), rows, 'and the rows stay where they are');
  await page.mouse.up();
  await page.waitForSelector('#obstacle-list button[aria-pressed="true"]');
  await page.click('#tab-log');

  const figures = await page.textContent('#instruments');
  const strip = await page.locator('#timeline').boundingBox();
  await page.mouse.click(strip.x + 0.3 * strip.width, strip.y + strip.height / 2);
  await page.waitForSelector('#live[aria-pressed="false"]');
  await page.click('#play');
  await page.waitForSelector('#play[data-playing="false"]');
  const past = await now(page);
  assert.ok(past < 45, `the past is shown, not ${past} s`);
  assert.notEqual(await page.textContent('#instruments'), figures);
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

test('voxels come to a page that shows them, and are drawn', async () => {
  const scene = source('scenarios/bridge.toml');
  const program = await serve('bridge', scene, '--port', '0', '--speed', '8', '--set', 'simulation.duration_s=40');
  const page = await open('about:blank');
  await page.addInitScript(() => {
    const seen = (window.seen = { kinds: new Set(), asked: [] });
    const packed = [new Uint8Array(), new Uint8Array()]; // by channel
    const take = (bytes) => {
      const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.length);
      for (let at = 0; at + 24 <= bytes.length; at += 24 + 8 * Math.ceil(view.getUint32(at + 4, true) / 8)) {
        const kind = view.getUint8(at);
        if (kind !== 21) {
          seen.kinds.add(kind);
          continue;
        }
        const [channel, offset] = [view.getUint32(at + 8, true), view.getUint32(at + 24, true)];
        const slice = bytes.subarray(at + 32, at + 24 + view.getUint32(at + 4, true));
        packed[channel] = new Uint8Array([...(offset === 0 ? [] : packed[channel]), ...slice]);
        if (packed[channel].length < view.getUint32(at + 28, true)) continue;
        const plain = new Blob([packed[channel]]).stream().pipeThrough(new DecompressionStream('deflate'));
        new Response(plain).arrayBuffer().then((records) => take(new Uint8Array(records)));
      }
    };
    const Socket = window.WebSocket;
    window.WebSocket = class extends Socket {
      constructor(...address) {
        super(...address);
        this.addEventListener('message', ({ data }) => take(new Uint8Array(data)));
      }
      send(text) {
        seen.asked.push(text);
        super.send(text);
      }
    };
  });
  await page.goto(program.url);
  await state(page, 'open');
  await page.waitForFunction(() => window.seen.kinds.has(16)); // cubes
  assert.equal(await page.evaluate(() => window.seen.kinds.has(11)), false, 'the chart needs no voxels');
  await page.click('#tab-space');
  await page.waitForFunction(() => window.seen.kinds.has(11));
  await page.waitForFunction(() => Number(document.querySelector('#space-canvas').dataset.voxels) > 100);
  await page.waitForFunction(() => /[0-9] voxels/.test(document.querySelector('#space-readout').textContent));
  assert.doesNotMatch(await page.textContent('#space-readout'), /cubes/);
  await page.waitForFunction(() => /[1-9]\d* obstacles?/.test(document.querySelector('#space-readout').textContent));
  await picture(page, 'voxels-1400');
  await page.click('#tab-sonar');
  await page.waitForFunction(() => /cubes/.test(window.seen.asked.filter((text) => /detail/.test(text)).at(-1)));
  assert.deepEqual(page.troubles, []);
  await page.close();
  await program.end();
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

test('an obstacle says by its number what and where it is, on the chart and in the list', async () => {
  const tape = await serve('obstacles', '--port', '0', '--speed', 'max', '--set', 'simulation.duration_s=150');
  await tape.until(/written to/);
  const page = await open(tape.url);
  await state(page, 'open');
  const all = async (p) => {
    const told = (await p.getAttribute('#plan-canvas', 'data-obstacles')) ?? '';
    return told.split(';').map((one) => one.split(' ').map(Number));
  };
  const ages = 'known for [\\d.]+ (s|min), last seen [\\d.]+ (s|min) ago';
  const where = '[\\d.]+ m away, bearing (\\d{3}|–)°(, margin [\\d.]+ m)?';
  const size = '(compact|extended), [\\d.]+ m across';
  const told = new RegExp(`^Obstacle \\d+: ${size}, ${ages}, ${where}$`);
  const says = (p, id, timeout = 60_000) =>
    p.waitForFunction(
      (n) => document.querySelector('#plan-readout').firstChild?.textContent.startsWith(`Obstacle ${n}:`),
      id,
      { timeout },
    );
  await page.waitForFunction(() => document.querySelector('#plan-canvas').dataset.obstacles);
  await page.click('#plan-fit');
  const canvas = await page.locator('#plan-canvas').boundingBox();
  const inside = ([, x, y], box) => x > 60 && y > 60 && x < box.width - 60 && y < box.height - 60;
  // A chart that was fitted to its window, or a scan that came late, moves the obstacles: where they are is read anew.
  const point = async (p, box, press) => {
    for (let attempt = 0; attempt < 60; ++attempt) {
      for (const one of (await all(p)).filter((each) => inside(each, box))) {
        await press(box.x + one[1], box.y + one[2]);
        const said = await says(p, one[0], 1000).catch(() => null);
        if (said) return one[0];
      }
    }
    return assert.fail('no obstacle of the chart says its number');
  };
  const id = await point(page, canvas, (x, y) => page.mouse.move(x, y));
  assert.match(await page.textContent('#plan-readout span'), told);
  await picture(page, 'obstacle-1400');
  await page.mouse.move(canvas.x + 5, canvas.y + canvas.height - 5);
  await page.waitForFunction(() => !/Obstacle/.test(document.querySelector('#plan-readout').textContent));

  await page.click('#tab-obstacles');
  await page.waitForSelector('#obstacle-list li[data-obstacle]');
  const rows = await page.$$eval('#obstacle-list li', (all) => all.map((li) => li.dataset.obstacle));
  assert.equal(new Set(rows).size, rows.length, 'a thing stands in the list once, whatever its pieces');
  assert.deepEqual(rows.map(Number).sort(), (await all(page)).map(([n]) => n).sort(), 'and so on the chart');
  assert.match(await page.textContent('#obstacle-sum'), /^\d+ obstacles? in the last scan/);
  assert.equal(Number(await page.textContent('#obstacle-count')), rows.length);
  const row = page.locator(`#obstacle-list li[data-obstacle="${id}"]`);
  assert.match(await row.textContent(), new RegExp(`^${id}${size}[\\d.]+ m, (\\d{3}|–)°`));
  await row.hover();
  await says(page, id);
  await page.mouse.move(canvas.x + 5, canvas.y + canvas.height - 5);
  await page.waitForFunction(() => !/Obstacle/.test(document.querySelector('#plan-readout').textContent));
  await row.locator('button').click();
  await page.mouse.move(canvas.x + 5, canvas.y + canvas.height - 5);
  await says(page, id);
  await page.waitForSelector(`#obstacle-list li[data-obstacle="${id}"].chosen`);
  await picture(page, 'obstacles-1400');
  await page.click('#tab-log');

  // The ruler says what the maps know along it.
  const [, ox, oy] = (await all(page)).find(([n]) => n === id);
  await page.click('#plan-ruler');
  await page.mouse.move(canvas.x + 30, canvas.y + 200);
  await page.mouse.down();
  await page.mouse.move(canvas.x + ox, canvas.y + oy, { steps: 4 });
  await page.mouse.up();
  await page.waitForFunction(() => /bearing/.test(document.querySelector('#plan-readout').textContent));
  assert.match(await page.textContent('#plan-readout'), new RegExp(`meets obstacle ${id} at [\\d.]+ m`));
  await picture(page, 'ruler-1400');

  const phone = await open(tape.url, 390, 844, 'dark', true);
  await state(phone, 'open');
  await phone.waitForFunction(() => document.querySelector('#plan-canvas').dataset.obstacles);
  await phone.click('#plan-fit');
  const small = await phone.locator('#plan-canvas').boundingBox();
  await point(phone, small, (x, y) => phone.touchscreen.tap(x, y));
  assert.match(await phone.textContent('#plan-readout span'), told, 'and goes on saying so');
  await picture(phone, 'obstacle-390');
  assert.deepEqual([...page.troubles, ...phone.troubles], []);
  await page.close();
  await phone.close();
  await tape.end();
});

/** A body of 1 m crosses the way of a vehicle that cannot stop, to be met after 24 s. */
const crossing = `
[scene]
duration_s = 28
[bottom]
kind = 'flat'
material = 'mud'
depth = 30
extent_m = 200
[vehicle]
file = '${source('vehicles/remus100.toml')}'
dynamic = true
start = [0, 0, 15]
speed = 1.5
[navigation]
kind = 'drift'
[mission]
speed = 1.5
[[mission_point]]
north = 60
east = 0
depth_m = 15
[[sonar]]
preset = 'oculus_m750d'
range_m = 50
bins = 100
interval_s = 0.2
[[cylinder]]
centre = [36, -24, 15]
radius = 0.5
length = 30
path = [[0, 36, -24, 15], [60, 36, 36, 15]]
`;

// ledger: S3-21
test('a body that moves is shown where it will be, and a decision says how near it passes', async () => {
  const scene = join(scratch, 'crossing.toml');
  writeFileSync(scene, crossing);
  const program = await serve('crossing', scene, '--port', '0', '--speed', 'max');
  await program.until(/written to/);
  const page = await open(program.url);
  await state(page, 'open');
  const passes = page.locator('#log-list li', { hasText: /passes at [\d.]+ m in [\d.]+ s/ }).first();
  await passes.locator('button').click();
  const chart = passes.locator('.speed-chart svg');
  assert.match(await chart.getAttribute('aria-label'), /^Planned speed: [\d.]+ m\/s at first.*; closest appr/);
  assert.match(await passes.textContent(), /plan of \d+ s/);
  await passes.locator('[data-action="seek"]').click();
  const predicted = (wanted) =>
    page.waitForFunction((some) => !document.querySelector('#plan-canvas').dataset.predicted === !some, wanted);
  await predicted(true);
  await page.waitForFunction(() => document.querySelector('#plan-canvas').dataset.meeting === 'vehicle body');
  await picture(page, 'crossing-1400');
  await page.keyboard.press('p');
  await predicted(false);
  await page.keyboard.press('Escape');
  await page.waitForFunction(() => document.querySelector('#plan-canvas').dataset.meeting === '');
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

// Threads of their own sense, map, decide, steer and show, as fast as they go.
// ledger: S5-59 S6-31
test('a mission with real threads is seen as it runs, its past as it was, and ends as it should', async () => {
  const mission = source('scenarios/simulated_mission_1.toml');
  const program = await serve('real-threads', mission, '--live', '--port', '0', '--speed', 'max');
  assert.match(program.said(), /live, speed max/);
  const page = await open(program.url);
  await state(page, 'open');
  await until(page, 20);
  await page.waitForSelector('#log-list li[data-decision]');
  await page.click('#tab-health');
  await page.waitForFunction(() => /pings/.test(document.querySelector('#health-counts').textContent));
  assert.ok((await count(page, 'pings')) > 0, 'pings are counted');
  assert.equal(await count(page, 'events and messages not shown'), 0);
  await picture(page, 'real-threads-health-1400');
  await page.click('#tab-log');
  await until(page, 45);
  await picture(page, 'real-threads-1400');

  const figures = await page.textContent('#instruments');
  const strip = await page.locator('#timeline').boundingBox();
  await page.mouse.click(strip.x + 0.3 * strip.width, strip.y + strip.height / 2);
  await page.waitForSelector('#live[aria-pressed="false"]');
  await page.waitForFunction((shown) => document.querySelector('#instruments').textContent !== shown, figures);
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
  await first.until(/written to/);
  const end = await open(first.url);
  await end.waitForFunction(() => /over/.test(document.querySelector('#connection').textContent));
  await picture(end, 'over-1400');
  await end.click('#play');
  await end.waitForSelector('#live[aria-pressed="false"]');
  await end.waitForFunction(() => Number(document.querySelector('#timeline').getAttribute('aria-valuenow')) < 20);
  assert.equal(await end.isHidden('#notice'), true, 'no notice after the end');
  await end.close();
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

  // Plots know the whole recording, also what was never shown, and lead to each of its moments.
  await page.click('#tab-plots');
  await page.waitForSelector('figure[data-signal="depth"]');
  assert.ok(Number(await page.getAttribute('figure[data-signal="depth"]', 'data-samples')) > 35);
  assert.match(await page.textContent('figure[data-signal="speed"] figcaption'), /^speed [\d.]+ m\/s, speed set-point [\d.]+ m\/s$/);
  await page.click('#plots-chosen');
  await page.click('#plots-choice label:has-text("heading")');
  await page.waitForSelector('figure[data-signal="heading"] .u-over');
  const plot = await page.locator('figure[data-signal="speed"] .u-over').boundingBox();
  await page.mouse.click(plot.x + 0.75 * plot.width, plot.y + plot.height / 2);
  await page.waitForFunction(() => Math.abs(Number(document.querySelector('#timeline').getAttribute('aria-valuenow')) - 30) < 3);
  await picture(page, 'plots-1400');
  assert.deepEqual(page.troubles, []);
  await page.close();
  await program.end();
});
