// The program that serves a page, and a browser that looks at it, for tests and measurements.
//
// Needs ISOBATH_PROGRAM and ISOBATH_CHROMIUM; ISOBATH_SCREENSHOTS names a folder for pictures to be looked at.
import { spawn } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

const { chromium } = createRequire(new URL('../../web/package.json', import.meta.url))('playwright-core');
export const scratch = mkdtempSync(join(tmpdir(), 'isobath-page-'));
export const source = (path) => new URL(`../../${path}`, import.meta.url).pathname;
const patience = 60_000; // ms; what is waited for comes far sooner, and a loaded machine decides nothing

let browser;
const programs = [];
export async function start() {
  const quiet = ['disable-background-networking', 'disable-component-update', 'disable-sync', 'no-first-run'];
  const args = ['--no-sandbox', '--disable-gpu', '--disable-quic', ...quiet.map((flag) => `--${flag}`)];
  browser = await chromium.launch({ executablePath: process.env.ISOBATH_CHROMIUM, args });
}
export async function stop() {
  for (const program of programs) program.kill('SIGKILL'); // of those that failed
  await browser?.close();
  rmSync(scratch, { recursive: true, force: true });
}

/** The program, until it says where its page is. */
export async function serve(name, ...args) {
  const out = ['--out', join(scratch, name)];
  const program = spawn(process.env.ISOBATH_PROGRAM, ['serve', ...args, ...out], { stdio: ['ignore', 'pipe', 'pipe'] });
  programs.push(program);
  const over = new Promise((resolve) => program.on('exit', resolve));
  let said = '';
  const url = await new Promise((resolve, reject) => {
    const hear = (text) => {
      said += text;
      const found = /http:\/\/\S+/.exec(said);
      if (found) resolve(found[0]);
    };
    program.stdout.on('data', hear);
    program.stderr.on('data', hear);
    program.on('exit', (code) => reject(new Error(`the program ended with ${code}: ${said}`)));
  });
  return {
    url,
    port: new URL(url).port,
    said: () => said,
    until: (wanted) =>
      new Promise((resolve) => {
        const wait = setInterval(() => {
          if (!wanted.test(said)) return;
          clearInterval(wait);
          resolve();
        }, 50);
      }),
    end: async (signal = 'SIGINT') => {
      program.kill(signal);
      return over;
    },
  };
}

export async function open(url, width = 1400, height = 900, scheme = 'light', hasTouch = false) {
  const page = await browser.newPage({ viewport: { width, height }, colorScheme: scheme, hasTouch });
  page.setDefaultTimeout(patience);
  page.troubles = [];
  page.on('pageerror', (error) => page.troubles.push(String(error)));
  page.on('requestfailed', (request) => page.troubles.push(`${request.url()} failed`));
  await page.goto(url);
  return page;
}

export const state = (page, wanted) => page.waitForSelector(`#connection[data-state="${wanted}"]`);
/** s since the start, as the page shows it. */
export const now = async (page) => Number(await page.getAttribute('#timeline', 'aria-valuenow'));
export const until = (page, seconds) =>
  page.waitForFunction((s) => Number(document.querySelector('#timeline').getAttribute('aria-valuenow')) >= s, seconds);
export async function picture(page, name) {
  if (process.env.ISOBATH_SCREENSHOTS) {
    await page.screenshot({ path: join(process.env.ISOBATH_SCREENSHOTS, `${name}.png`) });
  }
}
