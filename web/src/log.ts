/** DecisionLog: the decisions with agent and reason, newest first. A selected one is shown on the chart. */
import { arrange, byId, make, mark, say } from './dom';
import type { Decision } from './items';
import { isPlan, planned } from './plan/prediction';
import { Kind } from './protocol';
import { speedChart } from './speed_chart';
import * as units from './units';
import type { Shared, View } from './view';

/** Rows shown at a time, which keeps the page small. */
const kRows = 200;

export class DecisionLog implements View {
  private readonly list = byId('log-list');
  private readonly filter = byId<HTMLInputElement>('log-filter');
  private readonly agent = byId<HTMLSelectElement>('log-agent');
  private readonly more = byId<HTMLButtonElement>('log-more');
  private rows = kRows;
  private drawn = '';
  private agents = '';
  private readonly made = new WeakMap<Decision, HTMLElement>();

  constructor(
    private readonly shared: Shared,
    private readonly seek: (to: number) => void,
  ) {
    const again = () => {
      this.rows = kRows;
      shared.redraw();
    };
    this.filter.addEventListener('input', again);
    this.agent.addEventListener('change', again);
    this.more.addEventListener('click', () => {
      this.rows += kRows;
      shared.redraw();
    });
  }

  frame(): void {
    const { model, selected } = this.shared;
    this.announce();
    say(byId('log-count'), model.decisions.length > 0 ? ` ${units.count(model.decisions.length)}` : '');
    if (this.list.clientWidth === 0) return;
    const canSeek = (model.clock?.end ?? 0) > (model.clock?.start ?? 0);
    const asked = `${this.filter.value} ${this.agent.value} ${this.rows}`;
    const look = `${model.revision[Kind.decision]} ${asked} ${selected?.number} ${canSeek}`;
    if (look === this.drawn) return;
    this.listAgents();
    const wanted = this.filter.value.trim().toLowerCase();
    const found = model.decisions.filter(
      (d) =>
        (this.agent.value === '' || d.agent === this.agent.value) &&
        (wanted === '' || `${d.agent} ${d.what} ${d.reason}`.toLowerCase().includes(wanted)),
    );
    const shown = found.slice(-this.rows).reverse();
    if (arrange(this.list, shown.map((decision) => this.row(decision, canSeek)))) this.drawn = look;
    this.more.hidden = found.length <= this.rows;
    byId('log-none').hidden = shown.length > 0;
    say(byId('log-none'), model.decisions.length > 0 ? 'No decision matches.' : 'No decisions yet.');
  }

  /** Tells a screen reader the newest decision of a live view, not those that were there before. */
  private announce(): void {
    const { clock, decisions } = this.shared.model;
    const newest = decisions.at(-1);
    if (clock?.live !== true || !newest) return;
    if (this.told !== null && newest.number > this.told) {
      say(byId('announce'), `${newest.agent}: ${newest.what}. ${newest.reason}`);
    }
    this.told = newest.number;
  }
  private told: number | null = null;

  /** A row keeps its element, so that a press on it ends on it. */
  private row(decision: Decision, canSeek: boolean): HTMLElement {
    const { model, selected } = this.shared;
    const since = model.scene ? decision.time - model.scene.start : NaN;
    const item = this.made.get(decision) ?? this.element(decision);
    this.made.set(decision, item);
    say(item.querySelector('time')!, units.elapsed(since));
    const chosen = selected?.number === decision.number;
    item.querySelector('button')!.setAttribute('aria-pressed', String(chosen));
    item.classList.toggle('chosen', chosen);
    const told = chosen ? `${since} ${canSeek}` : '';
    if ((item.dataset.told ?? '') !== told) {
      item.querySelector('.log-details')?.remove();
      if (chosen) item.append(this.details(decision, since, canSeek));
      mark(item, 'told', told);
    }
    return item;
  }

  private element(decision: Decision): HTMLElement {
    const { margin, approach } = decision;
    const head = make(
      'span',
      { class: 'log-head' },
      make('span', { class: 'log-number' }, String(decision.number)),
      make('time'),
      make('span', { class: 'log-agent' }, decision.agent),
      make('strong', {}, decision.what),
      ...(margin === undefined ? [] : [make('span', { class: 'log-margin' }, `margin ${units.metres(margin)}`)]),
      ...(approach === undefined ? [] : [make('span', { class: 'log-margin' }, passing(approach))]),
    );
    const reason = make('span', { class: 'log-reason' }, decision.reason);
    const button = make('button', { type: 'button', class: 'log-row' }, head, reason);
    button.addEventListener('click', () => this.shared.showDecision(decision));
    button.addEventListener('pointerenter', () => this.shared.pointAt(decision));
    button.addEventListener('pointerleave', () => this.shared.pointAt(null));
    return make('li', { 'data-decision': decision.number }, button);
  }

  private details(decision: Decision, since: number, canSeek: boolean): HTMLElement {
    const parts: string[] = [];
    const { obstacle, obstacleNumber } = decision;
    if (obstacle) {
      const name = obstacleNumber === undefined ? 'obstacle' : `obstacle ${obstacleNumber}`;
      parts.push(`${name} at N ${units.metres(obstacle[0])}, E ${units.metres(obstacle[1])}`);
    }
    if (decision.leg !== undefined) parts.push(`leg ${decision.leg}`);
    const length = units.metres(lengthOf(decision.way), 0);
    if (isPlan(decision)) parts.push(`plan of ${units.age(planned(decision.way))}, ${length}`);
    else if (decision.way.length > 1) parts.push(`route of ${decision.way.length} points, ${length}`);
    const { scene } = this.shared.model;
    const date = scene ? units.utc(scene.start + since) : '';
    if (date !== '') parts.push(date);
    const box = make('div', { class: 'log-details' }, make('span', {}, parts.join(' · ')));
    if (canSeek && Number.isFinite(since)) {
      const go = make(
        'button',
        { type: 'button', class: 'small', 'data-action': 'seek' },
        `Go to ${units.elapsed(since)}`,
      );
      go.addEventListener('click', () => this.seek(since));
      box.append(go);
    }
    if (isPlan(decision)) box.append(speedChart(decision));
    return box;
  }

  private listAgents(): void {
    const names = [...new Set(this.shared.model.decisions.map(({ agent }) => agent))].sort();
    const look = names.join('\n');
    if (look === this.agents) return;
    this.agents = look;
    const chosen = this.agent.value;
    this.agent.replaceChildren(
      make('option', { value: '' }, 'all agents'),
      ...names.map((name) => make('option', { value: name }, name)),
    );
    this.agent.value = names.includes(chosen) ? chosen : '';
  }
}

/** "passes at 1.5 m in 12 s". */
export function passing({ in: within, gap }: NonNullable<Decision['approach']>): string {
  return gap > 0 ? `passes at ${units.metres(gap)} in ${units.age(within)}` : `would touch in ${units.age(within)}`;
}

function lengthOf(way: Decision['way']): number {
  let length = 0;
  for (let i = 1; i < way.length; ++i) length += Math.hypot(way[i]![0] - way[i - 1]![0], way[i]![1] - way[i - 1]![1]);
  return length;
}
