/** Connection: shows in the header whether the page is up to date, and a notice above everything when it is not. */
import { byId, mark, say } from './dom';
import type { Feed } from './feed';
import * as units from './units';
import type { Shared } from './view';

/** ms: without a message for this long, while the clock runs, the page is stale. */
const kSilent = 3000;

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
    const { feed } = this;
    const { clock } = this.shared.model;
    const old = Number.isFinite(feed.heard) ? (now - feed.heard) / 1000 : NaN;
    const runs = (clock?.playing ?? false) || ((clock?.live ?? false) && !clock?.over);
    const silent = feed.state.is === 'open' && runs && old * 1000 > kSilent;
    const state = silent ? 'silent' : feed.state.is;
    mark(this.badge, 'state', state);
    say(this.badge, this.words(state));
    const text = this.trouble(state, old, now);
    this.notice.hidden = text === '';
    say(this.notice, text);
    document.body.classList.toggle(
      'stale',
      (state === 'lost' || state === 'silent' || state === 'connecting') && Number.isFinite(old),
    );
    this.rates();
    this.refusals();
  }

  private words(state: string): string {
    const { clock } = this.shared.model;
    switch (state) {
      case 'open':
        if (clock?.over) return '■ run is over';
        return clock?.live ? '● live' : '● connected';
      case 'connecting':
        return '○ connecting';
      case 'lost':
        return '✕ connection lost';
      case 'silent':
        return '▲ no data';
      case 'unreadable':
        return '✕ unreadable';
      default:
        return '■ stored run';
    }
  }

  private trouble(state: string, old: number, now: number): string {
    const seen = Number.isFinite(old) ? ` What you see is ${units.age(old)} old.` : '';
    const { state: is } = this.feed;
    if (is.is === 'lost') {
      const wait = Math.max(0, Math.ceil((is.retry - now) / 1000));
      return `▲ Connection lost, trying again in ${wait} s.${seen}`;
    }
    if (is.is === 'connecting' && seen) return `▲ Connection lost, trying now.${seen}`;
    if (is.is === 'unreadable') return `▲ The run in this page cannot be read: ${is.why}.`;
    return state === 'silent' ? `▲ No data received.${seen}` : '';
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
    const not = kNot[request] ?? `Request refused${request ? ` (${request})` : ''}`;
    toast(`${not}: ${why}`);
  }
}

const kNot: Record<string, string | undefined> = {
  control: 'Control refused',
  hold: 'Hold refused',
  resume: 'Resume refused',
  abort: 'Abort refused',
};

let fading = 0;
export function toast(text: string): void {
  const box = byId('toast');
  say(box, text);
  box.hidden = false;
  window.clearTimeout(fading);
  fading = window.setTimeout(() => (box.hidden = true), 5000);
}
