/** Timeline: the shown time within the run, the marks of decisions and alarms, and the speed of play. */
import { byId, context, fit, make, mark, pixelRatio, say } from './dom';
import type { Clock } from './items';
import type { Marks } from './marks';
import { Kind } from './protocol';
import { roundStep } from './units';
import * as units from './units';
import type { Shared, View } from './view';

/** ms between two seeks while the user drags along the line. */
const kScrub = 100;

export class Timeline implements View {
  private readonly strip = byId('timeline');
  private readonly canvas = byId<HTMLCanvasElement>('timeline-canvas');
  private readonly playButton = byId<HTMLButtonElement>('play');
  private readonly liveButton = byId<HTMLButtonElement>('live');
  private readonly speed = byId<HTMLSelectElement>('speed');
  private scrubbed: number | null = null;
  private asked = -Infinity;
  private hovered: number | null = null;
  private drawn = '';

  constructor(
    private readonly shared: Shared,
    private readonly marks: Marks,
  ) {
    const { ask } = shared;
    this.playButton.addEventListener('click', () => this.toggle());
    this.liveButton.addEventListener('click', () => this.goLive());
    byId('step-back').addEventListener('click', () => ask({ ask: 'step', steps: -1 }));
    byId('step-forward').addEventListener('click', () => ask({ ask: 'step', steps: 1 }));
    this.speed.addEventListener('change', () => ask({ ask: 'speed', times: Number(this.speed.value) }));
    this.liveButton.hidden = true;
    this.listen();
  }

  toggle(): void {
    this.shared.ask({ ask: this.shared.model.clock?.playing ? 'pause' : 'play' });
  }
  /** Returns to the live view, if there is one. */
  goLive(): void {
    if (this.shared.model.clock?.hasNow) this.shared.ask({ ask: 'live' });
  }
  seek(to: number): void {
    this.shared.ask({ ask: 'seek', to_s: Math.round(to * 1000) / 1000 });
  }

  frame(): void {
    const { model, theme } = this.shared;
    const { clock } = model;
    this.marks.update();
    const resized = fit(this.canvas);
    const told = `${model.revision[Kind.clock]} ${model.revision[Kind.scene]} ${this.marks.revision}`;
    const look = `${told} ${this.shared.link.isLive} ${theme.revision} ${this.scrubbed} ${this.hovered} ${model.now.toFixed(1)}`;
    if (look === this.drawn && !resized) return;
    this.drawn = look;
    this.tell(clock);
    this.draw(clock);
  }

  private tell(clock: Clock | null): void {
    const { model } = this.shared;
    const playing = clock?.playing ?? false;
    const live = clock?.live ?? false;
    mark(this.playButton, 'playing', String(playing));
    this.playButton.setAttribute('aria-label', playing ? 'Pause' : 'Play');
    this.playButton.title = playing ? 'Pause (space)' : 'Play (space)';
    this.liveButton.hidden = !(clock?.hasNow ?? false);
    this.liveButton.setAttribute('aria-pressed', String(live));
    say(this.liveButton, this.liveWords(clock));
    this.tellSpeed(clock);
    const now = this.scrubbed ?? model.now;
    say(byId('time-now'), units.elapsed(now));
    say(byId('time-end'), clock ? `of ${units.elapsed(clock.end, 0)}` : '');
    const [date = '', ...clockTime] = model.scene ? units.utc(model.scene.start + now).split(' ') : [];
    say(byId('time-date'), date);
    say(byId('time-clock'), clockTime.join(' '));
    this.strip.setAttribute('aria-valuemin', (clock?.start ?? 0).toFixed(1));
    this.strip.setAttribute('aria-valuemax', (clock?.end ?? now).toFixed(1));
    this.strip.setAttribute('aria-valuenow', now.toFixed(1));
    this.strip.setAttribute('aria-valuetext', `${units.elapsed(now)} since the start`);
  }

  /** The button says LIVE only while what is shown is live. */
  private liveWords(clock: Clock | null): string {
    const { link, model } = this.shared;
    if (clock?.over) return clock.live ? 'AT THE END' : 'Go to the end';
    const log = model.scene?.simulated === false;
    if (!clock?.live) return log ? 'Go to newest' : 'Go live';
    return log || !link.isLive ? 'NEWEST' : 'LIVE';
  }

  /** A run has its own speed, which a page cannot change; of the past and of a recording it can. */
  private tellSpeed(clock: Clock | null): void {
    const speed = clock?.speed ?? 1;
    const value = String(speed);
    this.speed.disabled = clock?.live === true && !clock.over;
    this.speed.title = this.speed.disabled ? 'Speed of the run' : 'Speed of play';
    const own = this.speed.querySelector<HTMLOptionElement>('[data-own]');
    const known = [...this.speed.options].some((option) => option !== own && option.value === value);
    if (known) own?.remove();
    else if (own?.value !== value) {
      own?.remove();
      this.speed.append(make('option', { value, 'data-own': true }, speed > 0 ? `× ${Number(speed.toPrecision(3))}` : '× max'));
    }
    if (document.activeElement !== this.speed && this.speed.value !== value) this.speed.value = value;
  }

  private draw(clock: Clock | null): void {
    const { theme, model } = this.shared;
    const { paint } = theme;
    const drawing = context(this.canvas);
    const ratio = pixelRatio();
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight];
    drawing.setTransform(ratio, 0, 0, ratio, 0, 0);
    drawing.clearRect(0, 0, width, height);
    const middle = height - 22;
    const now = this.scrubbed ?? model.now;
    drawing.fillStyle = paint.grid;
    drawing.fillRect(kSide, middle - 3, width - 2 * kSide, 6);
    if (!clock) return;
    const x = (t: number) => this.x(t, clock, width);
    drawing.fillStyle = paint.track;
    drawing.fillRect(kSide, middle - 3, Math.max(0, x(now) - kSide), 6);
    drawing.font = '11px system-ui, sans-serif';
    drawing.textBaseline = 'alphabetic';
    drawing.textAlign = 'center';
    const step = stepOf((clock.end - clock.start) / Math.max(2, width / 90));
    drawing.fillStyle = paint.faint;
    for (let t = Math.ceil(clock.start / step) * step; t <= clock.end; t += step) {
      drawing.fillRect(x(t), middle + 3, 1, 4);
      if (x(t) > 16 && x(t) < width - 16) drawing.fillText(units.elapsed(t, step < 1 ? 1 : 0), x(t), height - 4);
    }
    for (const { at, alarm } of this.marks.all.values()) {
      if (at < clock.start - 1 || at > clock.end + 1) continue;
      if (alarm) {
        drawing.fillStyle = paint.ruler;
        triangle(drawing, x(at), middle - 7, 6);
      } else {
        drawing.fillStyle = paint.decision;
        drawing.fillRect(x(at) - 1, middle - 10, 2, 16);
      }
    }
    drawing.fillStyle = paint.ink;
    drawing.beginPath();
    drawing.arc(x(now), middle, 7, 0, 2 * Math.PI);
    drawing.fill();
    this.hint(drawing, clock, width);
  }

  /** The mark under the pointer. */
  private hint(drawing: CanvasRenderingContext2D, clock: Clock, width: number): void {
    if (this.hovered === null) return;
    const { paint } = this.shared.theme;
    const near = [...this.marks.all.values()]
      .map((m) => ({ ...m, off: Math.abs(this.x(m.at, clock, width) - this.hovered!) }))
      .filter(({ off }) => off < 6)
      .sort((a, b) => a.off - b.off)[0];
    const at = near?.at ?? this.time(this.hovered, clock, width);
    const text = near ? `${units.elapsed(at, 0)}  ${near.alarm ? '▲ ' : ''}${near.what}` : units.elapsed(at, 0);
    drawing.font = '12px system-ui, sans-serif';
    const wide = drawing.measureText(text).width;
    const x = Math.min(width - wide / 2 - 4, Math.max(wide / 2 + 4, this.hovered));
    drawing.fillStyle = paint.ink;
    drawing.textAlign = 'center';
    drawing.textBaseline = 'top';
    drawing.fillText(text, x, 1);
  }

  private x(t: number, clock: Clock, width: number): number {
    const span = Math.max(1e-3, clock.end - clock.start);
    return kSide + Math.min(1, Math.max(0, (t - clock.start) / span)) * (width - 2 * kSide);
  }
  private time(x: number, clock: Clock, width: number): number {
    const share = Math.min(1, Math.max(0, (x - kSide) / Math.max(1, width - 2 * kSide)));
    return clock.start + share * (clock.end - clock.start);
  }

  private listen(): void {
    const { strip, shared } = this;
    const at = (event: PointerEvent) => event.clientX - this.canvas.getBoundingClientRect().left;
    const scrub = (event: PointerEvent, last: boolean) => {
      const { clock } = shared.model;
      if (!clock) return;
      this.scrubbed = this.time(at(event), clock, this.canvas.clientWidth);
      if (last || event.timeStamp - this.asked > kScrub) {
        this.asked = event.timeStamp;
        this.seek(this.scrubbed);
      }
      if (last) this.scrubbed = null;
      shared.redraw();
    };
    strip.addEventListener('pointerdown', (event) => {
      if (event.button !== 0) return;
      strip.setPointerCapture(event.pointerId);
      this.asked = -Infinity;
      scrub(event, false);
    });
    strip.addEventListener('pointermove', (event) => {
      this.hovered = event.pointerType === 'mouse' ? at(event) : null;
      if (this.scrubbed !== null) scrub(event, false);
      shared.redraw();
    });
    strip.addEventListener('pointerup', (event) => this.scrubbed !== null && scrub(event, true));
    strip.addEventListener('pointercancel', () => (this.scrubbed = null));
    strip.addEventListener('pointerleave', () => {
      this.hovered = null;
      shared.redraw();
    });
    strip.addEventListener('keydown', (event) => {
      const { clock, now } = shared.model;
      const to =
        clock &&
        ({ PageUp: now - 10, PageDown: now + 10, Home: clock.start, End: clock.end } as Record<string, number>)[
          event.key
        ];
      if (to === null || to === undefined) return;
      event.preventDefault();
      this.seek(to);
    });
    strip.addEventListener('selectstart', (event) => event.preventDefault());
  }
}

const kSide = 10;

function triangle(drawing: CanvasRenderingContext2D, x: number, y: number, size: number): void {
  drawing.beginPath();
  drawing.moveTo(x, y - 2 * size);
  drawing.lineTo(x + size, y);
  drawing.lineTo(x - size, y);
  drawing.closePath();
  drawing.fill();
}

/** The smallest step of a clock's scale that is not below `least`, s. */
function stepOf(least: number): number {
  return (
    [0.1, 0.2, 0.5, 1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 14400].find((s) => s >= least) ??
    roundStep(least)
  );
}
