// The echoes of the spherical grid in the 3-D view of the live page, as an operator chooses them.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { now, open, picture, serve, start, state, stop } from './program.mjs';

const kRun = ['--port', '0', '--speed', 'max', '--set', 'simulation.duration_s=90', '--set', 'sphere.lock_echoes=5'];
let program;
before(async () => {
  await start();
  program = await serve('echoes', ...kRun);
  await program.until(/written to/);
});
after(stop);

const kControls = ['#space-from', '#space-to', '#space-which', '#space-coarser'];
const kWords =
  /([\d,]+) of ([\d,]+) cells with echoes drawn(?: \(([\d,]+) merged\))?, (?:none|([\d,]+) of ([\d,]+)) locked/;
const mark = (page, name) => page.$eval('#space-canvas', (canvas, of) => canvas.dataset[of] ?? '', name);
const settle = async (page, act) => {
  await act();
  await page.evaluate(() => new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn))));
  await page.waitForFunction(() => document.body.dataset.behind === 'false');
};
/** The cells that are drawn, all of them, those that were merged, and the locked ones. */
async function cells(page, act = async () => {}) {
  await settle(page, act);
  const text = await page.textContent('#space-readout');
  const found = kWords.exec(text);
  assert.ok(found, text);
  const [drawn, all, merged, locked, allLocked] = found.slice(1).map((t) => Number((t ?? '0').replaceAll(',', '')));
  return { drawn, all, merged, locked, allLocked };
}
async function openSpace(...how) {
  const page = await open(program.url, ...how);
  await state(page, 'open');
  const phone = await page.isVisible('#tabs');
  await page.click(phone ? '#tabs [data-show="space"]' : '#tab-space');
  await page.click('#space-sphere');
  await page.waitForFunction(
    (words) => new RegExp(words).test(document.querySelector('#space-readout').textContent),
    kWords.source,
  );
  return page;
}
const setTo = (page, id, layer) =>
  page.$eval(
    id,
    (input, value) => {
      input.value = value;
      input.dispatchEvent(new Event('input', { bubbles: true }));
    },
    String(layer),
  );

// ledger: S4-16
test('only the echoes between two distances are drawn', async () => {
  const page = await openSpace();
  const whole = await cells(page);
  assert.ok(whole.all > 50, 'there are echoes');
  assert.equal(whole.drawn, whole.all);
  const end = Number(await page.getAttribute('#space-to', 'max'));
  assert.ok(end > 50, 'a layer is a step of the range');
  const middle = Math.round(0.4 * end);
  const near = await cells(page, () => setTo(page, '#space-to', middle));
  const said = await page.textContent('#space-range-text');
  assert.match(said, /^0 m to [\d.]+ m$/);
  assert.equal(await page.getAttribute('#space-to', 'aria-valuetext'), said.split(' to ')[1]);
  await setTo(page, '#space-to', end);
  const far = await cells(page, () => setTo(page, '#space-from', middle + 1));
  assert.equal(near.drawn + far.drawn, whole.all, 'what is not near is far');
  assert.equal(near.all, whole.all);
  await setTo(page, '#space-from', 0);
  // One band of layers after the other is all of them.
  let sum = 0;
  const band = Math.ceil((end + 1) / 6);
  for (let layer = 0; layer <= end; layer += band) {
    await setTo(page, '#space-to', Math.min(end, layer + band - 1));
    sum += (await cells(page, () => setTo(page, '#space-from', layer))).drawn;
  }
  assert.equal(sum, whole.all);
  await setTo(page, '#space-to', 0);
  assert.equal(await page.inputValue('#space-from'), '0', 'one end pushes the other along');
  await setTo(page, '#space-from', end);
  assert.equal(await page.inputValue('#space-to'), String(end));
  assert.deepEqual(page.troubles, []);
  await page.close();
});

// ledger: S4-14 S4-17
test('cells are merged into wider ones, and the locked ones are drawn alone', async () => {
  const page = await openSpace();
  await page.click('#enlarge');
  const whole = await cells(page);
  assert.ok(whole.allLocked > 0 && whole.allLocked < whole.all, 'some cells are locked');
  const which = (value) => () => page.selectOption('#space-which', value);
  const locked = await cells(page, which('locked'));
  assert.deepEqual([locked.drawn, locked.locked, locked.all], [whole.allLocked, whole.allLocked, whole.all]);
  await picture(page, 'echoes-locked-1400');
  const others = await cells(page, which('open'));
  assert.deepEqual([others.drawn, others.locked], [whole.all - whole.allLocked, 0]);
  await page.selectOption('#space-which', 'all');
  let last = whole.all;
  for (const times of ['2', '4']) {
    const wide = await cells(page, () => page.selectOption('#space-coarser', times));
    assert.equal(wide.merged, whole.all);
    assert.ok(wide.all < last && wide.all > 0 && wide.drawn === wide.all);
    assert.ok(wide.allLocked > 0 && wide.allLocked <= whole.allLocked);
    last = wide.all;
    await picture(page, `echoes-coarser-${times}-1400`);
  }
  assert.deepEqual(page.troubles, []);
  await page.close();
});

// ledger: S4-19 S4-20 S4-37 S4-39
test('twelve lines have bearings from north or from the bow, seen from above and aslant', async () => {
  const page = await openSpace();
  await page.click('#enlarge');
  for (const box of ['#space-water', '#space-bottom', '#space-voxels']) await page.click(box);
  await settle(page, () => page.click('#space-above'));
  assert.equal(await mark(page, 'bearings'), '');
  await settle(page, () => page.click('#space-bearings'));
  const written = async () => (await mark(page, 'bearings')).split(',');
  const tens = Array.from({ length: 12 }, (_, i) => `${String(30 * i).padStart(3, '0')}°`);
  assert.deepEqual((await written()).slice(0, 12), tens);
  assert.match((await written()).slice(12).join(), /^([\d.]+ m,?)+$/, 'rings say their distance');
  assert.equal(await mark(page, 'looks'), '000° 90° down', 'north is up');
  await picture(page, 'echoes-north-up-1400');

  const heading = () => page.textContent('#now-heading');
  await settle(page, () => page.click('#space-course'));
  assert.equal(await mark(page, 'looks'), `${await heading()} 90° down`, 'the bow is up');
  const sides = (await written()).slice(0, 12);
  assert.deepEqual(
    [sides[0], sides[1], sides[3], sides[6], sides[11]],
    ['ahead', '30° stb', '90° stb', 'astern', '30° port'],
  );
  await picture(page, 'echoes-course-up-1400');
  const before = await heading();
  const strip = await page.locator('#timeline').boundingBox();
  for (const share of [0.2, 0.4, 0.6]) {
    const at = await now(page);
    await page.mouse.click(strip.x + share * strip.width, strip.y + strip.height / 2);
    await page.waitForFunction(
      (t) => Number(document.querySelector('#timeline').getAttribute('aria-valuenow')) !== t,
      at,
    );
    await page.waitForFunction(
      () =>
        document.querySelector('#space-canvas').dataset.looks ===
        `${document.querySelector('#now-heading').textContent} 90° down`,
    );
    if ((await heading()) !== before) break;
  }
  assert.notEqual(await heading(), before, 'the vehicle has turned, and the view with it');
  await settle(page, () => page.click('#space-course'));
  assert.equal(await mark(page, 'looks'), '000° 90° down', 'north is up again');

  await settle(page, () => page.click('#space-fit'));
  assert.match(await mark(page, 'looks'), /^\d{3}° [1-7]\d° down$/);
  await picture(page, 'echoes-aslant-1400');
  await page.click('#live');
  await page.waitForSelector('#live[aria-pressed="true"]');
  await settle(page, () => page.click('#theme'));
  await settle(page, () => page.click('#space-above'));
  await picture(page, 'echoes-night-1400');
  assert.deepEqual(page.troubles, []);
  await page.close();
});

test('the choices outlast a reload, and keys alone reach them', async () => {
  const page = await openSpace();
  const whole = await cells(page);
  await page.focus('#space-sphere');
  const reached = [];
  for (let i = 0; i < 20 && reached.length < kControls.length; ++i) {
    await page.keyboard.press('Tab');
    const id = await page.evaluate(() => `#${document.activeElement.id}`);
    if (kControls.includes(id)) reached.push(id);
    if (id === '#space-bearings') await page.keyboard.press('Space');
    if (id === '#space-from') for (let k = 0; k < 30; ++k) await page.keyboard.press('ArrowRight');
    if (id === '#space-to') for (let k = 0; k < 10; ++k) await page.keyboard.press('ArrowLeft');
    if (id === '#space-which') await page.keyboard.press('n'); // "not locked"
    if (id === '#space-coarser') await page.keyboard.press('ArrowDown');
  }
  assert.deepEqual(reached, kControls);
  for (const id of [...kControls, '#space-above', '#space-bearings']) {
    const named = await page.$eval(
      id,
      (e) => e.getAttribute('aria-label') ?? e.labels?.[0]?.textContent ?? e.textContent,
    );
    assert.ok(named.trim().length > 3, `${id} says what it is`);
  }
  await page.focus('#space-canvas');
  await settle(page, () => page.keyboard.press('v'));
  assert.match(await mark(page, 'looks'), /90° down/);
  const values = () => page.$$eval(kControls.join(), (all) => all.map((input) => input.value));
  const [kept, chosen] = [await values(), await cells(page)];
  assert.deepEqual(kept.slice(2), ['open', '2']);
  assert.ok(chosen.drawn < chosen.all && chosen.all < whole.all);
  await page.reload();
  await state(page, 'open');
  await page.click('#tab-space');
  await page.waitForFunction(
    (words) => new RegExp(words).test(document.querySelector('#space-readout').textContent),
    kWords.source,
  );
  assert.deepEqual(await cells(page), chosen);
  assert.deepEqual(await values(), kept);
  assert.equal(await page.isChecked('#space-bearings'), true);
  assert.deepEqual(page.troubles, []);
  await page.close();
});

test('a phone has room for the controls and the view, by night too', async () => {
  const page = await openSpace(390, 844, 'dark', true);
  await settle(page, () => page.tap('#space-bearings'));
  await settle(page, () => page.tap('#space-above'));
  for (const id of [...kControls, '#space-above', '#space-bearings', '#space-range-text']) {
    const box = await page.locator(id).boundingBox();
    assert.ok(box.x >= 0 && box.x + box.width <= 390, `${id} is within the screen`);
  }
  const stage = await page.locator('#space-canvas').boundingBox();
  assert.ok(stage.height > 250, `the view is ${stage.height} high`);
  const track = await page.locator('#space-range').boundingBox();
  const middle = track.y + track.height / 2;
  await settle(page, async () => {
    await page.mouse.move(track.x + track.width - 9, middle);
    await page.mouse.down();
    await page.mouse.move(track.x + track.width / 2, middle, { steps: 4 });
    await page.mouse.up();
  });
  const { drawn, all } = await cells(page);
  assert.ok(drawn < all, 'the thumb of the far end takes the pointer');
  assert.equal(await page.inputValue('#space-from'), '0');
  await picture(page, 'echoes-390');
  assert.deepEqual(page.troubles, []);
  await page.close();
});
