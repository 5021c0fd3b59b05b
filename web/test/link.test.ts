import { describe, expect, test } from 'vitest';
import { readClock } from '../src/items';
import { Link } from '../src/link';
import type { Request } from '../src/request';

/** A program whose clock is 100 s ahead of the page's, and a link of so many ms each way. */
class Harbour {
  now = 5000;
  private readonly timers: { at: number; then: () => void }[] = [];
  private frame = 0;
  private seen = -1;
  private seenAt = 0;
  answers: number[] = [];
  readonly link = new Link((request) => this.hear(request), {
    now: () => this.now,
    later: (ms, then) => void this.timers.push({ at: this.now + ms, then }),
  });

  constructor(
    public down: number,
    public up: number,
  ) {}

  private hear(request: Request): boolean {
    if (request.ask !== 'seen') return false;
    const { frame } = request;
    this.answers.push(frame);
    const comes = this.now + this.up;
    this.timers.push({ at: comes, then: () => ((this.seen = frame), (this.seenAt = comes / 1000 + 100)) });
    return true;
  }
  /** The program sends what it knows now. */
  send(): void {
    const json = { now_s: 0, frame: ++this.frame, made_s: this.now / 1000 + 100, seen: this.seen, seen_s: this.seenAt };
    const clock = readClock(json);
    this.timers.push({ at: this.now + this.down, then: () => (this.link.applied(clock), this.link.drew()) });
  }
  pass(ms: number, every = 100): void {
    for (const end = this.now + ms; this.now < end; this.now += 10) {
      if (every > 0 && this.now % every === 0) this.send();
      for (const due of this.timers.filter(({ at }) => at <= this.now)) {
        this.timers.splice(this.timers.indexOf(due), 1);
        due.then();
      }
    }
  }
}

describe('how far a page is behind', () => {
  test('is the way of a frame and of an answer, whatever the clocks show', () => {
    const harbour = new Harbour(300, 200);
    expect(harbour.link.behind()).toBeNaN();
    harbour.pass(3000);
    expect(harbour.link.behind()).toBeGreaterThan(0.3);
    expect(harbour.link.behind()).toBeLessThan(0.3 + 0.2 + 0.25);
    expect(harbour.link.isLive).toBe(true);
  });

  test('grows with a queue on the link, which the program does not see', () => {
    const harbour = new Harbour(50, 50);
    harbour.pass(3000);
    harbour.down = 4000;
    harbour.pass(6000);
    expect(harbour.link.behind()).toBeGreaterThan(4);
    expect(harbour.link.behind()).toBeLessThan(4.3);
    expect(harbour.link.isLive).toBe(false);
  });

  test('grows while nothing comes, and a page is not called live again at once', () => {
    const harbour = new Harbour(50, 50);
    harbour.pass(3000);
    harbour.pass(2000, 0);
    expect(harbour.link.behind()).toBeGreaterThan(1.9);
    expect(harbour.link.isLive).toBe(false);
    harbour.pass(500);
    expect(harbour.link.behind()).toBeLessThan(0.3);
    expect(harbour.link.isLive).toBe(false);
    harbour.pass(1000);
    expect(harbour.link.isLive).toBe(true);
  });

  test('is not known after the computer slept, until an answer came', () => {
    const harbour = new Harbour(50, 50);
    harbour.pass(3000);
    harbour.link.applied(readClock({ now_s: 0, frame: 1e6, made_s: harbour.now / 1000 + 700, seen: -1, seen_s: 0 }));
    harbour.link.drew();
    expect(harbour.link.behind()).toBeNaN();
    expect(harbour.link.isLive).toBe(false);
  });

  test('is not known of a feed that does not tell it', () => {
    const harbour = new Harbour(50, 50);
    harbour.link.applied(readClock({ now_s: 3 }));
    expect(harbour.link.measures).toBe(false);
    expect(harbour.link.behind()).toBeNaN();
  });
});

test('a page answers ten times a second at most, and always the newest frame in the end', () => {
  const harbour = new Harbour(0, 0);
  harbour.pass(1000, 10);
  expect(harbour.answers.length).toBeGreaterThan(5);
  expect(harbour.answers.length).toBeLessThanOrEqual(11);
  harbour.pass(500, 0);
  expect(harbour.answers.at(-1)).toBe(100);
});
