/**
 * Planner: edits a mission on the chart before the vehicle gets it. Each change goes to the program, which checks the
 * draft and plans its way; *Send* gives it to the vehicle. Only a page with command plans.
 */
import { toast } from './connection';
import { byId, mark, say } from './dom';
import { DraftList } from './draft_list';
import type { Camera } from './plan/camera';
import { Draft } from './plan/draft';
import { drawDraft, drawPressed } from './plan/draft_layer';
import type { Pen } from './plan/pen';
import type { ChartEditor, PlanView } from './plan/plan';
import { Kind, type Point } from './protocol';
import { sumText, type Preview } from './preview';
import * as units from './units';
import type { Shared, View } from './view';

/** px: a press within this distance takes hold of a point. */
const kGrasp = 18;
/** ms after a change before the program is asked, and before it is asked again after a refusal. */
const kSettle = 250;
const kAgain = 1000;
/** m: the depth of a new point where neither mission nor vehicle has one. */
const kDepth = 2;
/** ms: the vehicle must have taken a mission within this time. */
const kTaken = 20000;

export class Planner implements View, ChartEditor {
  private readonly open = byId<HTMLButtonElement>('plan-mission');
  private readonly go = byId<HTMLButtonElement>('plan-go');
  private readonly panel = byId('draft');
  private readonly state = byId('draft-state');
  private readonly modes = {
    points: byId<HTMLButtonElement>('draft-points'),
    fence: byId<HTMLButtonElement>('draft-fence'),
  };
  private readonly undo = byId<HTMLButtonElement>('draft-undo');
  private readonly send = byId<HTMLButtonElement>('draft-send');
  private readonly list: DraftList;

  private draft: Draft | null = null;
  private edits: 'points' | 'fence' = 'points';
  private chosen: number | null = null;
  private held: number | null = null;
  private pressed: Point | null = null;

  private changedAt = 0;
  /** The revisions of the draft: when last changed, asked about, and answered. */
  private noticed = 0;
  private asked = 0;
  private answered = 0;
  private preview: Preview | null = null;
  private seenPreview = 0;
  private seenRefusal = 0;
  private refused = '';
  private sent: { decisions: number; until: number } | null = null;

  constructor(
    private readonly shared: Shared,
    private readonly chart: PlanView,
  ) {
    this.list = new DraftList({
      choose: (index) => this.choose(this.chosen === index ? null : index),
      setPoint: (index, part) => this.edit((draft) => draft.set(index, part)),
      setCorner: (index, at) => this.edit((draft) => draft.setCorner(index, at)),
      remove: (index) => this.remove(index),
    });
    this.open.addEventListener('click', () => (this.draft ? this.discard() : this.begin(true)));
    this.go.addEventListener('click', () => {
      const { pressed } = this;
      if (!pressed) return;
      this.begin(false);
      this.edit((draft) => draft.add(pressed));
    });
    for (const mode of ['points', 'fence'] as const) this.modes[mode].addEventListener('click', () => this.turnTo(mode));
    byId('draft-add').addEventListener('click', () => this.add([this.chart.section.north, this.chart.section.east]));
    this.undo.addEventListener('click', () => this.edit((draft) => draft.undo()));
    byId('draft-discard').addEventListener('click', () => this.discard());
    this.send.addEventListener('click', () => this.order());
    window.addEventListener('keydown', (event) => this.onKey(event));
    chart.editor = this;
  }

  /** Whether this page may plan now: it has command, and shows the present. */
  private get may(): boolean {
    const { clock, scene } = this.shared.model;
    if (!scene || scene.mission.length === 0 || scene.group.length > 1) return false;
    return clock?.control === true && clock.plans && clock.live && !clock.over;
  }
  private get here(): Point | null {
    const { vehicle } = this.shared.model;
    return vehicle && [vehicle.north, vehicle.east];
  }

  private begin(withPoints: boolean): void {
    const { scene, vehicle } = this.shared.model;
    if (!scene || !this.may) return;
    const depth = vehicle && vehicle.down > 0.5 ? Math.round(vehicle.down * 10) / 10 : kDepth;
    this.draft = new Draft(scene, withPoints, depth);
    this.edits = 'points';
    this.chosen = this.held = this.pressed = this.preview = this.sent = null;
    this.noticed = this.asked = this.answered = 0;
    this.refused = '';
    this.chart.follow(false);
    this.touch();
  }
  discard(): void {
    this.draft = this.pressed = this.chosen = this.held = this.preview = this.sent = null;
    this.touch();
  }
  private touch(): void {
    this.chart.refresh();
    this.shared.redraw();
  }
  private edit(change: (draft: Draft) => void): void {
    if (!this.draft || this.sent) return;
    change(this.draft);
    const count = this.edits === 'points' ? this.draft.points.length : this.draft.fence.length;
    if (this.chosen !== null && this.chosen >= count) this.chosen = null;
    this.touch();
  }
  private choose(index: number | null): void {
    this.chosen = index;
    this.touch();
  }
  private turnTo(mode: 'points' | 'fence'): void {
    this.edits = mode;
    this.choose(null);
  }
  private add(at: Point): void {
    this.edit((draft) => {
      const index = this.edits === 'points' ? draft.add(at) : draft.addCorner(at);
      if (index < 0) toast(`A draft has at most 100 ${this.edits === 'points' ? 'points' : 'corners'}.`);
      else this.chosen = index;
    });
  }
  private remove(index: number): void {
    this.edit((draft) => (this.edits === 'points' ? draft.remove(index) : draft.removeCorner(index)));
    this.choose(null);
  }

  private onKey(event: KeyboardEvent): void {
    const target = event.target as HTMLElement;
    if (target.matches('input, select, textarea') || document.querySelector('dialog[open]')) return;
    if (event.key === 'Escape' && this.pressed) {
      this.pressed = null;
      this.touch();
    }
    if (!this.draft) return;
    if ((event.key === 'Delete' || event.key === 'Backspace') && this.chosen !== null) {
      event.preventDefault();
      this.remove(this.chosen);
    } else if (event.key === 'z' && (event.ctrlKey || event.metaKey)) {
      event.preventDefault();
      this.edit((draft) => draft.undo());
    }
  }

  // The chart's gestures.

  get replacesMission(): boolean {
    return this.draft !== null;
  }
  grasp(camera: Camera, x: number, y: number): boolean {
    this.held = this.draft && !this.sent ? this.near(camera, x, y) : null;
    if (this.held === null) return false;
    this.draft!.lift();
    this.choose(this.held);
    return true;
  }
  pull(at: Point): void {
    const { held } = this;
    if (held === null) return;
    this.edit((draft) => (this.edits === 'points' ? draft.set(held, { at }) : draft.setCorner(held, at)));
  }
  release(): void {
    if (this.held === null) return;
    this.held = null;
    this.draft?.drop();
  }
  tap(camera: Camera, x: number, y: number): boolean {
    if (this.draft) {
      if (this.near(camera, x, y) === null) this.add(camera.place(x, y));
      return true;
    }
    this.pressed = this.may ? camera.place(x, y) : null;
    this.touch();
    return false;
  }
  private near(camera: Camera, x: number, y: number): number | null {
    const places = this.edits === 'points' ? this.draft!.points.map(({ at }) => at) : this.draft!.fence;
    let nearest: number | null = null;
    let least = kGrasp;
    places.forEach((at, i) => {
      const far = Math.hypot(camera.x(...at) - x, camera.y(...at) - y);
      if (far < least) [least, nearest] = [far, i];
    });
    return nearest;
  }
  draw(pen: Pen): void {
    const { draft, edits, chosen } = this;
    if (draft) drawDraft(pen, { draft, preview: this.current, edits, chosen, vehicle: this.here });
    else if (this.pressed) drawPressed(pen, this.pressed);
  }
  /** For the tests and the chart: where the points are, px. */
  told(camera: Camera): string {
    if (!this.draft) return '';
    return this.draft.points.map(({ at }) => `${camera.x(...at).toFixed(0)} ${camera.y(...at).toFixed(0)}`).join(';');
  }

  /** The answer to the newest change. */
  private get current(): Preview | null {
    return this.draft && this.answered === this.draft.revision ? this.preview : null;
  }

  // What the program says.

  private order(): void {
    const { draft } = this;
    if (!draft || this.send.disabled) return;
    this.shared.ask({ ask: 'mission', draft: draft.json() });
    const { decisions } = this.shared.model;
    this.sent = { decisions: decisions.at(-1)?.number ?? 0, until: performance.now() + kTaken };
    this.refused = '';
    this.touch();
  }

  private hear(now: number): void {
    const { model } = this.shared;
    const { draft } = this;
    if (model.revision[Kind.preview] !== this.seenPreview) {
      this.seenPreview = model.revision[Kind.preview]!;
      if (draft && model.preview && this.asked > 0) {
        this.preview = model.preview;
        this.answered = this.asked;
        this.asked = 0;
        this.touch();
      }
    }
    if (model.revision[Kind.refusal] !== this.seenRefusal) {
      this.seenRefusal = model.revision[Kind.refusal]!;
      if (model.refusal?.request === 'preview') {
        this.asked = 0;
        this.changedAt = now + kAgain;
      }
      if (model.refusal?.request === 'mission' && this.sent) this.notTaken(model.refusal.why);
    }
    if (!draft) return;
    if (this.noticed !== draft.revision) {
      this.noticed = draft.revision;
      this.changedAt = now;
      this.refused = '';
    }
    if (this.asked === 0 && this.answered !== draft.revision && now - this.changedAt >= kSettle && this.held === null && this.may) {
      this.asked = draft.revision;
      this.shared.ask({ ask: 'preview', draft: draft.json() });
    }
    if (this.sent) this.follow(draft, this.sent, now);
  }

  /** Whether the vehicle has taken the mission that was sent. */
  private follow(draft: Draft, sent: { decisions: number; until: number }, now: number): void {
    const { scene, decisions } = this.shared.model;
    if (scene && scene.missionNumber !== draft.mission) {
      toast('The vehicle has the new mission.');
      return this.discard();
    }
    const refusal = decisions.find(({ number, what }) => number > sent.decisions && /^refuse (mission|command)$/.test(what));
    if (refusal) return this.notTaken(refusal.reason);
    if (now > sent.until) this.notTaken('the vehicle has not answered; it may still take the mission');
  }
  private notTaken(why: string): void {
    this.sent = null;
    this.refused = why;
    this.touch();
  }

  frame(now: number): void {
    this.hear(now);
    const { may, draft } = this;
    if (!may && this.pressed) this.pressed = null;
    this.open.hidden = !may && !draft;
    this.open.setAttribute('aria-pressed', String(draft !== null));
    byId('plan-canvas').classList.toggle('planning', draft !== null);
    this.go.hidden = draft !== null || this.pressed === null;
    if (this.pressed) say(this.go, `Go here: N ${units.metres(this.pressed[0])}, E ${units.metres(this.pressed[1])}`);
    if (this.panel.hidden !== (draft === null)) this.panel.hidden = draft === null;
    if (!draft) return;
    for (const mode of ['points', 'fence'] as const) this.modes[mode].setAttribute('aria-pressed', String(this.edits === mode));
    const preview = this.current;
    this.undo.disabled = !draft.canUndo || this.sent !== null;
    this.send.disabled = !may || this.sent !== null || preview === null || preview.problem !== '';
    const words = this.words(draft, preview);
    say(this.state, words);
    mark(this.state, 'trouble', String(words.includes('▲')));
    mark(this.panel, 'checked', String(preview !== null));
    const { missionSpeed } = this.shared.model.scene ?? { missionSpeed: undefined };
    this.list.show({ draft, edits: this.edits, chosen: this.chosen, preview, missionSpeed });
  }

  private words(draft: Draft, preview: Preview | null): string {
    if (this.sent) return 'Sent; the vehicle has not taken it yet …';
    if (!this.may) return '▲ This page cannot send it now: it does not have command, or shows the past.';
    if ((this.shared.model.scene?.missionNumber ?? draft.mission) !== draft.mission)
      return '▲ The vehicle has another mission since this draft was begun. Discard it and begin again.';
    if (this.refused) return `▲ Not taken: ${this.refused}`;
    return preview ? sumText(preview) : 'The program checks the draft and plans its way …';
  }
}
