// The page over a slow link: it never calls old content live, and the program drops what the link does not carry.
import assert from 'node:assert/strict';
import { createRequire } from 'node:module';
import { after, before, test } from 'node:test';
import { open, picture, serve, source, start, stop } from './program.mjs';
import { slowLink } from './slow_link.mjs';

const WebSocket = createRequire(new URL('../../web/package.json', import.meta.url))('ws');

before(start);
after(stop);

/** When the program showed which time of the run: from a page beside it, without the slow link. */
async function listen(url) {
  const told = []; // [ms, s]
  const socket = new WebSocket(`${url.replace('http', 'ws')}socket`);
  await new Promise((resolve) => (socket.onopen = resolve));
  socket.onmessage = ({ data }) => {
    const now = /"now_s":([\d.]+)/.exec(data.toString('latin1'));
    if (now) told.push([Date.now(), Number(now[1])]);
  };
  /** How long ago, s, the run was past the time that a page showed at `ms`. */
  const age = ({ ms, now }) => {
    const later = told.find(([, s]) => s > now + 0.1);
    return later ? Math.max(0, (ms - later[0]) / 1000) : 0;
  };
  return { age, end: () => socket.close() };
}

/** What the page says, ten times a second. */
const watch = (page, seconds) =>
  page.evaluate(async (last) => {
    const seen = [];
    const text = (id) => document.querySelector(id).textContent;
    for (const end = Date.now() + last * 1000; Date.now() < end; await new Promise((r) => setTimeout(r, 100))) {
      const now = Number(document.querySelector('#timeline').getAttribute('aria-valuenow'));
      const live = [text('#connection'), text('#live')].some((words) => /LIVE/.test(words));
      seen.push({ ms: Date.now(), now, said: text('#connection'), live, sonar: text('#sonar-age'), dim: document.body.classList.contains('stale') });
    }
    return seen;
  }, seconds);

const scenes = [['the embedded scene', ['--speed', '4']], ['two fans of 61 kB a ping', [source('scenarios/bridge.toml')]]];
// Both where a person looks; one is enough to guard it.
for (const [name, run] of scenes.slice(0, process.env.ISOBATH_WATCH ? 2 : 1)) {
  test(`at 256 kbit/s and 600 ms a page is at most 2 s behind, and live only within 1 s: ${name}`, async () => {
    const program = await serve('slow', '--port', '0', ...run);
    const truth = await listen(program.url);
    const link = await slowLink(program.port, { rate: 32_000, delay: 300 });
    const page = await open(link.url);
    await page.waitForFunction(() => /LIVE|BEHIND/.test(document.querySelector('#connection').textContent));
    await new Promise((resolve) => setTimeout(resolve, 2000));
    const seen = await watch(page, Number(process.env.ISOBATH_WATCH ?? 4));
    const ages = seen.map((one) => truth.age(one));
    const worst = Math.max(...ages);
    const falselyLive = seen.filter(({ live }, i) => live && ages[i] > 1);
    const words = `worst ${worst.toFixed(2)} s; live ${seen.filter(({ live }) => live).length} of ${seen.length}`;
    if (process.env.ISOBATH_WATCH) console.log(name, words, ages.map((a) => a.toFixed(1)).join(' '), seen.map(({ said }) => said).join(' | '), seen.map(({ sonar }) => sonar).join(' | '));
    assert.deepEqual(falselyLive, [], words);
    assert.ok(worst < 2, words);
    for (const { said, dim } of seen) assert.equal(dim, !/LIVE/.test(said), said);
    await picture(page, `slow-${run.length}-1400`);

    // A link that carries nothing more is told within a second or so, with the age of what is shown.
    link.cut = true;
    const cut = Date.now();
    await page.waitForFunction(() => /BEHIND|no data/.test(document.querySelector('#connection').textContent));
    assert.ok(Date.now() - cut < 3000, 'a cut link is told');
    assert.equal(await page.evaluate(() => getComputedStyle(document.querySelector('#instruments')).filter === 'none'), false);
    await page.waitForFunction(() => /old/.test(document.querySelector('#notice').textContent));
    await picture(page, `cut-${run.length}-1400`);
    assert.deepEqual(page.troubles, []);
    truth.end();
    link.end();
    await page.close();
    await program.end();
  });
}
