/**
 * Link: how far the page is behind the program, from end to end, and the acknowledgements by which the program sends no
 * more than the link carries (docs/live-page.md).
 *
 * Each frame has a number and `made`, the time of the program's own clock at which its content was complete. The page
 * answers with the number as soon as it has applied the frame; the program tells when that answer came (`seenAt`). An
 * answer is on its way for some time, so the program's clock is ahead of the page's by at most seenAt less the time of
 * the answer. The smallest such bound of the last 30 s gives the age of what is shown, or somewhat more: too much by the
 * shortest way of an answer, never too little. The age grows while nothing comes.
 */
import type { Clock } from './items';
import type { Request } from './request';

/** ms: the server accepts 20 messages a second. */
const kAnswerEvery = 100;
/** s */
const kRemember = 30;
/** s: what the two clocks may disagree by rounding. */
const kSlack = 0.05;
/** s: the page is called live below this, and for so long after it was not. */
export const kLive = 1;

export class Link {
  private clock: Clock | null = null;
  private drawn: Clock | null = null;
  private told = 0;
  private readonly answers = new Map<number, number>();
  private bounds: { at: number; ahead: number }[] = [];
  private waiting = false;
  private lastAnswer = -Infinity;
  private lateAt = -Infinity;

  constructor(
    private readonly ask: (request: Request) => boolean,
    private readonly around: { now(): number; later(ms: number, then: () => void): void },
  ) {}

  /** Call it when a message has been applied. */
  applied(clock: Clock | null): void {
    if (clock?.frame === undefined || clock === this.clock) return;
    if (clock.frame < this.told) this.forget();
    this.clock = clock;
    this.told = clock.frame;
    const now = this.around.now();
    const answered = this.answers.get(clock.seen);
    if (answered !== undefined) {
      for (const frame of this.answers.keys()) if (frame <= clock.seen) this.answers.delete(frame);
      this.bounds = this.bounds.filter(({ at }) => (now - at) / 1000 < kRemember);
      this.bounds.push({ at: now, ahead: clock.seenAt - answered / 1000 });
    }
    // A frame from the future: one of the clocks stood still, as in a computer that slept.
    if (clock.made !== undefined && clock.made - now / 1000 > this.ahead + kSlack) this.bounds = [];
    this.answer();
  }

  /** Call it when the model has been drawn. */
  drew(): void {
    this.drawn = this.clock;
  }

  /** s: how old what is shown is, at most; NaN: not known yet. */
  behind(hidden = false): number {
    const { made } = (hidden ? this.clock : this.drawn) ?? {};
    return made === undefined ? NaN : this.age(made);
  }
  /** s: how old the samples of sonars and the maps are. */
  mapsBehind(): number {
    return this.clock?.maps === undefined ? NaN : this.age(this.clock.maps);
  }
  /** Whether what is shown may be called live: it is not old now, and was not a moment ago. True if the feed does not tell. */
  get isLive(): boolean {
    if (!this.measures) return true;
    const now = this.around.now() / 1000;
    const behind = this.behind();
    if (behind > kLive) this.lateAt = now;
    return behind <= kLive && now - this.lateAt > kLive;
  }
  /** Whether the program tells its delay: a stored run has none. */
  get measures(): boolean {
    return this.clock !== null;
  }

  forget(): void {
    this.clock = this.drawn = null;
    this.told = 0;
    this.answers.clear();
    this.bounds = [];
    this.lastAnswer = -Infinity;
  }

  private age(made: number): number {
    return Math.max(0, this.around.now() / 1000 - made + this.ahead);
  }
  private get ahead(): number {
    return this.bounds.length === 0 ? NaN : Math.min(...this.bounds.map(({ ahead }) => ahead));
  }

  private answer(): void {
    const now = this.around.now();
    const wait = kAnswerEvery - (now - this.lastAnswer);
    if (wait > 0) {
      if (!this.waiting) this.around.later(wait, () => ((this.waiting = false), this.answer()));
      this.waiting = true;
      return;
    }
    if (this.told === 0 || this.answers.has(this.told) || !this.ask({ ask: 'seen', frame: this.told })) return;
    this.lastAnswer = now;
    this.answers.set(this.told, now);
  }
}
