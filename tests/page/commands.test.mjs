// A page with the token holds, resumes and aborts a mission; a page without it cannot.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { open, picture, scratch, serve, source, start, state, stop, until } from './program.mjs';

before(start);
after(stop);

const token = 'what only the skipper knows';

/** Refused for a reason, as /metrics counts it; it is made anew ten times a second. */
async function refused(program, reason) {
  await new Promise((resolve) => setTimeout(resolve, 150));
  const metrics = await (await fetch(`${program.url}metrics`)).text();
  const line = metrics.split('\n').find((text) => text.startsWith(`isobath_web_refused_total{reason="${reason}"}`));
  return Number(line?.split(' ')[1] ?? 0);
}
const phase = (page, wanted) => page.waitForSelector(`#command-bar[data-phase="${wanted}"]`);
const slower = (page, than) =>
  page.waitForFunction((limit) => Number.parseFloat(document.querySelector('#now-speed').textContent) < limit, than);
const faster = (page, than) =>
  page.waitForFunction((limit) => Number.parseFloat(document.querySelector('#now-speed').textContent) > limit, than);
const decided = (page, what) =>
  page.waitForFunction(
    (words) =>
      [...document.querySelectorAll('#log-list li[data-decision]')].some((li) =>
        words.every((word) => li.textContent.includes(word)),
      ),
    what,
  );
async function say(page, words) {
  await page.fill('#command-token', words);
  await page.click('#command-form button');
}

test('with the token a mission is held, resumed and aborted; without it nothing is commanded', async () => {
  const file = join(scratch, 'token');
  writeFileSync(file, `${token}\n`);
  const program = await serve(
    'commanded',
    '--port',
    '0',
    '--speed',
    '4',
    '--token-file',
    file,
    '--set',
    'simulation.duration_s=900',
  );
  const page = await open(program.url);
  await state(page, 'open');
  await faster(page, 1); // once its sonar has turned

  await page.click('#tab-health');
  assert.equal(await page.isVisible('#command-hold'), false, 'no buttons before the token');
  await say(page, 'what anybody might guess');
  await page.waitForSelector('#toast:not([hidden])');
  assert.match(await page.textContent('#toast'), /not the token/);
  assert.equal(await page.isVisible('#command-hold'), false);
  assert.equal(await refused(program, 'token'), 1);
  await picture(page, 'command-token-1400');
  await say(page, token);
  await page.waitForSelector('#command-hold:not([disabled])');
  assert.equal(await page.isVisible('#command-form'), false);
  await phase(page, 'under way');
  await picture(page, 'command-under-way-1400');

  await page.click('#tab-log');
  await page.click('#command-hold');
  await phase(page, 'holding');
  assert.match(await page.textContent('#instruments'), /holding/);
  await decided(page, ['captain', 'hold', 'the operator asks for it']);
  await slower(page, 0.4);
  assert.ok(await page.isDisabled('#command-hold'), 'it holds already');
  await picture(page, 'command-holding-1400');

  const other = await open(program.url, 390, 844);
  await state(other, 'open');
  await other.waitForFunction(() => /holding/.test(document.querySelector('#instruments').textContent));
  assert.equal(await other.isVisible('#command-bar'), false, 'the token of one page is not that of another');
  const answer = await other.evaluate(async () => {
    const socket = new WebSocket(`ws://${location.host}/socket`);
    socket.binaryType = 'arraybuffer';
    await new Promise((resolve) => (socket.onopen = resolve));
    socket.send(JSON.stringify({ ask: 'command', command: 'abort' }));
    return new Promise((resolve) => {
      socket.onmessage = ({ data }) => {
        const text = new TextDecoder('latin1').decode(data);
        const found = /\{[^{}]*may not command[^{}]*\}/.exec(text);
        if (found) resolve(found[0]);
      };
    });
  });
  assert.match(answer, /command/);
  assert.equal(await refused(program, 'no_control'), 1);
  assert.match(await other.textContent('#instruments'), /holding/, 'and nothing came of it');

  await page.click('#command-resume');
  await phase(page, 'under way');
  await decided(page, ['captain', 'resume']);
  await faster(page, 1);

  await page.click('#command-abort');
  assert.match(await page.textContent('#command-abort'), /again/, 'an abort is asked for twice');
  await picture(page, 'command-abort-1400');
  assert.equal(await page.getAttribute('#command-bar', 'data-phase'), 'under way');
  await page.click('#command-abort');
  await phase(page, 'aborted');
  await decided(page, ['captain', 'abort', 'the operator ended the mission']);
  for (const button of ['hold', 'resume', 'abort']) assert.ok(await page.isDisabled(`#command-${button}`));
  await other.waitForFunction(() => /aborted/.test(document.querySelector('#instruments').textContent));
  await picture(page, 'command-aborted-1400');
  assert.deepEqual([...page.troubles, ...other.troubles], []);

  await other.click('#tabs [data-show="health"]');
  await picture(other, 'command-token-390');
  await say(other, token);
  await other.waitForSelector('#command-bar:not([hidden])');
  assert.match(await other.textContent('#toast'), /may command/);
  await picture(other, 'command-aborted-390');
  await page.close();
  await other.close();
  await program.end();
  assert.match(program.said(), /abort/);
});

// ledger: S1-43
test('an alarm is shown until its cause is over and it has been acknowledged', async () => {
  const file = join(scratch, 'token');
  writeFileSync(file, `${token}\n`);
  const scene = join(scratch, 'short_leak.toml');
  const leak = readFileSync(source('scenarios/faults/leak.toml'), 'utf8');
  writeFileSync(scene, leak.replace('at_s = 20', 'at_s = 2\nfor_s = 1'));
  const program = await serve('alarm', scene, '--port', '0', '--speed', '0.5', '--token-file', file);
  const page = await open(program.url);
  await state(page, 'open');
  await page.click('#tab-health');
  await say(page, token);
  await page.waitForFunction(() => /Alarm: leak.*lasts, not acknowledged/.test(document.body.textContent));
  await page.waitForSelector('#command-acknowledge:not([disabled])');
  await picture(page, 'alarm-1400');
  await page.click('#command-acknowledge');
  await page.waitForFunction(() => !/Alarm: leak/.test(document.querySelector('#alarms').textContent));
  assert.ok(await page.isDisabled('#command-acknowledge'));
  await page.click('#tab-log');
  await decided(page, ['captain', 'acknowledge', 'the operator has seen the alarms']);
  assert.deepEqual(page.troubles, []);
  await page.close();
  await program.end();
});

test('where the program was given no token, no page offers to command', async () => {
  const program = await serve('uncommanded', '--port', '0', '--speed', '4');
  const page = await open(program.url);
  await state(page, 'open');
  await until(page, 1);
  await page.click('#tab-health');
  assert.equal(await page.isVisible('#commands'), false);
  assert.equal(await page.isVisible('#command-bar'), false);
  await page.close();
  await program.end();
});
