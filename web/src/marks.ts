/**
 * What the time line marks: decisions and alarms. They are kept when the model forgets, as it does with each jump in
 * time: what was decided later in a run is still to be found there. Another run forgets them.
 */
import type { Mark } from './items';
import type { Model } from './model';
import { Kind } from './protocol';

const kMost = 5000;

export class Marks {
  readonly all = new Map<string, Mark>();
  revision = 0;
  private start = NaN;
  private seen = '';
  private raised = new Set<string>();

  constructor(private readonly model: Model) {}

  update(): void {
    const { model } = this;
    const { scene, health, decisions, revision } = model;
    const seen = `${revision[Kind.scene]} ${revision[Kind.decision]} ${revision[Kind.health]}`;
    if (!scene || seen === this.seen) return;
    this.seen = seen;
    if (scene.start !== this.start) {
      this.all.clear();
      this.raised.clear();
      this.start = scene.start;
      ++this.revision;
    }
    for (const mark of scene.marks) this.put(`told ${mark.at} ${mark.what}`, mark);
    for (const { number, time, agent, what } of decisions) {
      this.put(`decision ${number}`, { at: time - scene.start, what: `${agent}: ${what}`, alarm: false });
    }
    const now = new Set(health?.alarms);
    for (const { fault, active, since } of health?.faults ?? []) {
      if (since !== undefined) this.put(`fault ${fault} ${since}`, { at: since, what: fault, alarm: true });
      else if (active) now.add(fault);
    }
    for (const what of now) {
      if (!this.raised.has(what)) this.put(`alarm ${what} ${model.now.toFixed(0)}`, { at: model.now, what, alarm: true });
    }
    this.raised = now;
  }

  private put(key: string, mark: Mark): void {
    if (this.all.has(key) || this.all.size >= kMost) return;
    this.all.set(key, mark);
    ++this.revision;
  }
}
