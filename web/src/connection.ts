/**
 * Connection: shows in the header what the page shows (the present of a vehicle, a log, the past, a recording) and
 * whether that is up to date, and a notice above everything when it is not.
 */
import { byId, mark, say } from './dom';
import type { Feed } from './feed';
import type { Clock } from './items';
import { kLive } from './link';
import * as units from './units';
import type { Shared } from './view';

/** ms: without a message for this long, the page is stale. A feed that tells its delay sends one twice a second. */
const kSilent = 3000;
/** s: sonar and maps that are older than what is acted on are told from this age on. */
const kLateMaps = 2;

/** What is shown; it has a colour, a sign and a word of its own. */
export type Shown = 'live' | 'log' | 'past' | 'recording' | 'over' | 'stored';
const kSigns: Record<Shown, string> = {
  live: '● LIVE',
  log: '▤ LOG',
  past: '◀ PAST',
  recording: '▶ RECORDING',
  over: '■ run is over',
  stored: '■ stored run',
};

export function shownOf(clock: Clock | null, simulated: boolean, feed: Feed): Shown {
  if (feed.state.is === 'stored') return 'stored';
  if (clock && !clock.hasNow) return 'recording';
  if (clock && !clock.live) return 'past';
  if (clock?.over) return 'over';
  return simulated || !clock ? 'live' : 'log';
}

export class Connection {
  private readonly badge = byId('connection');
  private readonly notice = byId('notice');
  private bytes = { at: 0, count: 0, rate: 0 };
  private frames = { at: 0, count: 0, rate: 0 };
  private refused = 0;

  constructor(
    private readonly shared: Shared,
    private readonly feed: Feed,
  ) {}

  drew(): void {
    ++this.frames.count;
  }

  /** Called a few times a second. */
  tick(now: number): void {
    this.measure(now);
    const { clock, scene } = this.shared.model;
    const shown = shownOf(clock, scene?.simulated ?? true, this.feed);
    const state = this.state(now, clock);
    mark(this.badge, 'state', state);
    mark(document.body, 'shows', shown);
    mark(document.body, 'link', state);
    say(this.badge, this.words(state, shown, clock));
    const text = this.trouble(state, now);
    this.notice.hidden = text === '';
    say(this.notice, text);
    const seen = Number.isFinite(this.feed.heard);
    document.body.classList.toggle('stale', seen && ['lost', 'silent', 'connecting', 'behind'].includes(state));
    this.rates();
    this.refusals();
  }

  private state(now: number, clock: Clock | null): string {
    const { feed } = this;
    const { link } = this.shared;
    if (feed.state.is !== 'open') return feed.state.is;
    const runs = link.measures || (clock?.playing ?? false) || ((clock?.live ?? false) && !clock?.over);
    if (runs && now - feed.heard > kSilent) return 'silent';
    if (!link.measures) return clock ? 'open' : 'connecting';
    if (Number.isNaN(this.behind)) return 'connecting';
    return link.isLive ? 'open' : 'behind';
  }

  private get behind(): number {
    return this.shared.link.behind(document.hidden);
  }

  private words(state: string, shown: Shown, clock: Clock | null): string {
    switch (state) {
      case 'connecting':
        return '○ connecting';
      case 'lost':
        return this.feed.state.is === 'lost' && this.feed.state.full ? '✕ no place left' : '✕ connection lost';
      case 'silent':
        return '▲ no data';
      case 'behind':
        return this.behind > kLive ? `▲ ${units.age(this.behind)} BEHIND` : '▲ catching up';
      case 'unreadable':
        return '✕ unreadable';
    }
    const simulation = this.shared.model.scene?.simulated && shown === 'live' ? ' simulation' : '';
    const paused = shown === 'recording' && !clock?.playing ? '❚❚ RECORDING' : kSigns[shown];
    const ago = shown === 'past' && clock?.present !== undefined ? ` ${units.elapsed(clock.now - clock.present, 0)}` : '';
    return `${paused}${ago}${simulation}`;
  }

  private trouble(state: string, now: number): string {
    const old = this.shared.link.measures ? this.behind : (now - this.feed.heard) / 1000;
    const seen = Number.isFinite(old) ? ` What you see is ${units.age(old)} old.` : '';
    const { state: is } = this.feed;
    if (is.is === 'lost') {
      const wait = Math.max(0, Math.ceil((is.retry - now) / 1000));
      const why = is.full ? 'The program serves as many pages as it may (max_clients)' : 'Connection lost';
      return `▲ ${why}, trying again in ${wait} s.${seen}`;
    }
    if (is.is === 'connecting' && Number.isFinite(this.feed.heard)) return `▲ Connection lost, trying now.${seen}`;
    if (is.is === 'unreadable') return `▲ The run in this page cannot be read: ${is.why}.`;
    if (state === 'silent') return `▲ No data received.${seen}`;
    if (state === 'behind' && this.behind > kLive) return `▲ The link is slow, or this device is:${seen.toLowerCase()}`;
    const maps = this.shared.link.mapsBehind();
    return state === 'open' && maps > kLateMaps ? `▲ Slow link: sonar and maps are ${units.age(maps)} behind.` : '';
  }

  private measure(now: number): void {
    for (const [meter, count] of [
      [this.bytes, this.feed.bytes],
      [this.frames, this.frames.count],
    ] as const) {
      if (now - meter.at < 1000) continue;
      const since = meter === this.bytes ? count - meter.count : count;
      meter.rate = (since * 1000) / (now - meter.at);
      meter.count = meter === this.bytes ? count : 0;
      meter.at = now;
    }
  }

  private rates(): void {
    say(byId('data-rate'), units.rate(this.bytes.rate));
    say(byId('frame-rate'), `${this.frames.rate.toFixed(0)} a second`);
    const { malformed, records, clock } = this.shared.model;
    const bad = [...malformed].map(([what, n]) => `${units.count(n)} of ${what}`).join(', ');
    say(byId('record-count'), units.count(records));
    say(byId('malformed-count'), bad || 'none');
    say(byId('program-version'), clock?.version || '–');
    say(byId('connection-words'), this.badge.textContent ?? '');
  }

  /** Shows a refused request for a while. */
  private refusals(): void {
    const { refusal } = this.shared.model;
    const revision = this.shared.model.revision[14]!;
    if (!refusal || revision === this.refused) return;
    this.refused = revision;
    const { request, why } = refusal;
    if (request === 'preview') return; // the planner asks again
    const not = kNot[request] ?? `Request refused${request ? ` (${request})` : ''}`;
    toast(`${not}: ${why}`);
  }
}

const kNot: Record<string, string | undefined> = {
  control: 'Control refused',
  hold: 'Hold refused',
  resume: 'Resume refused',
  abort: 'Abort refused',
  return: 'Return refused',
  mission: 'Mission refused',
};

let fading = 0;
export function toast(text: string): void {
  const box = byId('toast');
  say(box, text);
  box.hidden = false;
  window.clearTimeout(fading);
  fading = window.setTimeout(() => (box.hidden = true), 5000);
}
