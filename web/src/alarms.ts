/**
 * Alarms: the banner above all views, a sound, and a mark in the title of the tab. The sound repeats until this page has
 * acknowledged each alarm ("Seen"), or the alarm is over; it is silent while the past or a recording is shown. An
 * acknowledgement of the page silences this page only; that of the mission is a command (commands.ts).
 */
import { byId, mark, say } from './dom';
import { keep, kept } from './kept';
import { Kind } from './protocol';
import type { Shared, View } from './view';

const kKey = 'isobath-sound';
/** ms */
const kEvery = 2000;

export class Alarms implements View {
  private readonly banner = byId('alarms');
  private readonly text = byId('alarm-text');
  private readonly seenButton = byId<HTMLButtonElement>('alarm-seen');
  private readonly soundButton = byId<HTMLButtonElement>('alarm-sound');
  private lines: string[] = [];
  private readonly seen = new Set<string>();
  private look = '';
  private sounds = kept(kKey) !== 'off';
  private audio: AudioContext | null = null;
  private sounded = -Infinity;

  constructor(private readonly shared: Shared) {
    this.seenButton.addEventListener('click', () => {
      for (const line of this.lines) this.seen.add(line);
      this.shared.redraw();
    });
    this.soundButton.addEventListener('click', () => {
      this.sounds = !this.sounds;
      keep(kKey, this.sounds ? 'on' : 'off');
      if (this.sounds) void this.context()?.resume();
      this.shared.redraw();
    });
    // Browsers let a page sound only after its user has pressed something.
    window.addEventListener('pointerdown', () => void this.audio?.resume(), { passive: true });
    window.addEventListener('keydown', () => void this.audio?.resume());
  }

  frame(now: number): void {
    const { health, revision, clock, scene } = this.shared.model;
    const look = `${revision[Kind.health]} ${revision[0]}`;
    if (look !== this.look) this.lines = linesOf(health);
    this.look = look;
    for (const line of [...this.seen]) if (!this.lines.includes(line)) this.seen.delete(line);
    const unseen = this.lines.filter((line) => !this.seen.has(line));
    const present = clock?.live !== false && clock?.over !== true;
    this.banner.hidden = this.lines.length === 0;
    say(this.text, this.lines.map((line) => `▲ ${line}`).join('   '));
    mark(this.banner, 'seen', String(unseen.length === 0));
    this.seenButton.hidden = unseen.length === 0 || !present;
    this.soundButton.hidden = !present;
    say(this.soundButton, this.sounds ? (this.blocked ? 'Sound is blocked: press' : 'Sound on') : 'Sound off');
    this.soundButton.setAttribute('aria-pressed', String(this.sounds));
    const calls = unseen.length > 0 && present;
    const title = scene?.title || 'Isobath';
    const wanted = calls ? `▲ ${unseen[0]} · ${title}` : title;
    if (document.title !== wanted) document.title = wanted;
    if (calls && this.sounds && now - this.sounded > kEvery) {
      this.sounded = now;
      this.sound();
    }
  }

  private get blocked(): boolean {
    return this.audio?.state === 'suspended';
  }
  private context(): AudioContext | null {
    if (!this.audio && 'AudioContext' in window) this.audio = new AudioContext();
    return this.audio;
  }

  /** Two tones, which are heard over an engine and by those who hear high tones badly. */
  private sound(): void {
    const audio = this.context();
    if (!audio || audio.state === 'suspended') return;
    for (const [start, hertz] of [
      [0, 880],
      [0.25, 587],
    ] as const) {
      const tone = audio.createOscillator();
      const loud = audio.createGain();
      loud.gain.value = 0.2;
      tone.type = 'square';
      tone.frequency.value = hertz;
      tone.connect(loud).connect(audio.destination);
      tone.start(audio.currentTime + start);
      tone.stop(audio.currentTime + start + 0.2);
    }
  }
}

function linesOf(health: Shared['model']['health']): string[] {
  const lines = (health?.alarms ?? []).map((alarm) => `Alarm: ${alarm}`);
  for (const { fault, action, active } of health?.faults ?? []) {
    if (active) lines.push(`Fault: ${fault}${action ? ` (action: ${action})` : ''}`);
  }
  return lines;
}
