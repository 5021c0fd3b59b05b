/** HealthView: the health of the program: alarms and faults first, then refusals, counts and stage times. */
import type { AlignedData } from 'uplot';
import { Chart } from './chart';
import { byId, make, say } from './dom';
import type { Health, StageTime } from './items';
import { levelNote, type Level } from './levels';
import { Kind } from './protocol';
import * as units from './units';
import type { Shared, View } from './view';

/** Number of stage-time records kept. */
const kHistory = 1800;

export class HealthView implements View {
  private readonly chart: Chart;
  private readonly history = { time: [] as number[], p99: new Map<string, (number | null)[]>() };
  private seen: readonly StageTime[] = [];
  private drawn = '';
  private readonly opened = performance.now();

  constructor(private readonly shared: Shared) {
    this.chart = new Chart(byId('stage-chart'), shared.theme);
  }

  frame(now: number): void {
    const { model, theme } = this.shared;
    const { health } = model;
    if (model.times.length > 0 && model.times !== this.seen) this.remember(model.times, now);
    this.seen = model.times;
    const troubles = health ? health.alarms.length + health.faults.filter(({ active }) => active).length : 0;
    say(byId('health-count'), troubles > 0 ? ` ▲ ${troubles}` : '');
    const panel = byId('health-body');
    if (panel.clientWidth === 0) return;
    const look = `${model.revision[Kind.health]} ${model.revision[Kind.times]} ${model.revision[Kind.levels]} ${theme.revision} ${panel.clientWidth}`;
    if (look === this.drawn) return;
    this.drawn = look;
    this.levels(model.levels);
    byId('health-none').hidden = health !== null;
    if (!health) return;
    this.troubles(health);
    pairs(
      byId('health-counts'),
      health.counts.map(([name, n]) => [name, units.count(n)]),
    );
    pairs(
      byId('health-refused'),
      health.refused.map(([name, n]) => [name, units.count(n)]),
      'nothing refused',
    );
    pairs(byId('health-more'), health.more);
    byId('health-agents').replaceChildren(
      ...health.agents.map(({ name, state, why }) =>
        make('li', { 'data-agent': name }, make('strong', {}, name), ` ${state}${why ? `: ${why}` : ''}`),
      ),
    );
    this.stages(model.times);
  }

  private levels(levels: readonly Level[]): void {
    byId('level-section').hidden = levels.length === 0;
    byId('health-levels').replaceChildren(
      ...levels.map((level) => {
        const age = this.shared.model.age(level.since);
        const note = levelNote(level, Number.isFinite(age) ? units.age(Math.max(0, age)) : '');
        return make(
          'li',
          { 'data-level': level.level },
          make('strong', {}, level.level),
          ` ${level.command} `,
          make('small', {}, level.plan ? `${note}; at ${level.plan}` : note),
        );
      }),
    );
  }

  private troubles(health: Health): void {
    const list: HTMLElement[] = health.alarms.map((alarm) => trouble('Alarm', alarm, '', true));
    for (const { fault, why, action, active, since } of health.faults) {
      const text = [
        why,
        action && `action: ${action}`,
        since !== undefined && `${active ? 'since' : 'raised at'} ${units.elapsed(since)}`,
      ];
      list.push(trouble(active ? 'Fault' : 'Over', fault, text.filter(Boolean).join('; '), active));
    }
    if (list.length === 0) list.push(make('li', { class: 'trouble fine' }, '✓ No alarm, no fault'));
    byId('health-troubles').replaceChildren(...list);
  }

  private stages(stages: readonly StageTime[]): void {
    byId('stage-section').hidden = stages.length === 0;
    const rows = stages.map(({ name, median, p99, worst, count }, i) => {
      const swatch = make('span', { class: 'class-swatch' });
      swatch.style.background = this.chart.colour(i);
      const cells = [median, p99, worst].map((ms) => make('td', {}, units.milliseconds(ms)));
      return make('tr', {}, make('th', { scope: 'row' }, swatch, name), ...cells, make('td', {}, units.count(count)));
    });
    byId('stage-rows').replaceChildren(...rows);
    const names = [...this.history.p99.keys()];
    const data: AlignedData = [this.history.time, ...names.map((name) => this.history.p99.get(name)!)];
    if (this.history.time.length > 1) {
      this.chart.show(
        data,
        names.map((label, i) => ({ label, colour: i })),
        { x: 's since the page was opened', y: 'p99, ms' },
      );
    }
  }

  private remember(stages: readonly StageTime[], now: number): void {
    const { time, p99 } = this.history;
    time.push((now - this.opened) / 1000);
    for (const { name } of stages) {
      if (!p99.has(name) && p99.size < 12) p99.set(name, new Array<number | null>(time.length - 1).fill(null));
    }
    for (const [name, values] of p99) {
      const stage = stages.find((s) => s.name === name);
      values.push(stage && Number.isFinite(stage.p99) ? stage.p99 : null);
    }
    if (time.length <= kHistory) return;
    for (const values of [time, ...p99.values()]) values.shift();
  }
}

function trouble(kind: string, what: string, why: string, active: boolean): HTMLElement {
  const inside = [make('strong', {}, `${active ? '▲ ' : '✓ '}${kind}: ${what}`)];
  if (why) inside.push(make('span', {}, why));
  return make(
    'li',
    { class: active ? 'trouble active' : 'trouble', 'data-trouble': what, 'data-active': active ? 'true' : 'false' },
    ...inside,
  );
}

function pairs(list: HTMLElement, rows: readonly (readonly [string, string])[], none = '–'): void {
  const cells = rows.flatMap(([name, value]) => [make('dt', {}, name.replaceAll('_', ' ')), make('dd', {}, value)]);
  list.replaceChildren(...(cells.length > 0 ? cells : [make('dt', {}, none), make('dd')]));
}
