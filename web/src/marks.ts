/**
 * Marks: the decisions and alarms on the time line. They are kept when the model forgets, as it does at each jump in
 * time, so that later decisions of a run stay visible. Another run clears them: the program tells a new one by its name,
 * because simulated runs all start at the same time.
 */
import type { Mark } from './items';
import { Model } from './model';
import { each, type Block } from './player';
import { Kind } from './protocol';

const kMost = 5000;
/** s */
const kSame = 30;

export class Marks {
  readonly all = new Map<string, Mark>();
  revision = 0;
  private start = NaN;
  private run = '';
  private seen = '';
  private raised = new Set<string>();

  constructor(private readonly model: Model) {}

  update(): void {
    const { model } = this;
    const { scene, health, decisions, revision } = model;
    const run = model.clock?.run ?? '';
    const seen = `${run} ${revision[Kind.scene]} ${revision[Kind.decision]} ${revision[Kind.health]}`;
    if (!scene || seen === this.seen) return;
    this.seen = seen;
    if (scene.start !== this.start || (run !== '' && run !== this.run)) {
      this.all.clear();
      this.raised.clear();
      this.start = scene.start;
      this.run = run;
      ++this.revision;
    }
    for (const mark of scene.marks) this.put(`told ${mark.at} ${mark.what}`, mark);
    for (const { number, time, agent, what } of decisions) {
      this.put(`decision ${number}`, { at: time - scene.start, what: `${number}. ${agent}: ${what}`, alarm: false });
    }
    const now = new Set(health?.alarms);
    for (const { fault, active, since } of health?.faults ?? []) {
      if (since !== undefined) this.put(`fault ${fault} ${since}`, { at: since, what: fault, alarm: true });
      else if (active) now.add(fault);
    }
    for (const what of now) {
      // A jump into an alarm does not raise it again.
      const known = [...this.all.values()].some(
        (m) => m.alarm && m.what === what && Math.abs(m.at - model.now) < kSame,
      );
      if (!this.raised.has(what) && !known)
        this.put(`alarm ${what} ${model.now.toFixed(0)}`, { at: model.now, what, alarm: true });
    }
    this.raised = now;
  }

  /** Takes over the marks of a stored run, which are all known from the start. */
  adopt(others: Marks): void {
    this.start = others.start;
    for (const [key, mark] of others.all) this.put(key, mark);
  }

  private put(key: string, mark: Mark): void {
    if (this.all.has(key) || this.all.size >= kMost) return;
    this.all.set(key, mark);
    ++this.revision;
  }
}

/** All marks that a recording sets when it is played to its end. */
export function marksOf(blocks: readonly Block[]): Marks {
  const model = new Model();
  const marks = new Marks(model);
  const kinds = new Set<number>([Kind.scene, Kind.decision, Kind.health]);
  for (const { records } of blocks) {
    let news = false;
    each(records, (_key, from, to) => {
      if (!kinds.has(records[from]!)) return;
      model.take(records.subarray(from, to));
      news = true;
    });
    if (news) marks.update();
  }
  return marks;
}
