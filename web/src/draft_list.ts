/** DraftList: the points, or the corners of the fence, of a draft as rows that a keyboard edits too. */
import { arrange, byId, make, mark, say } from './dom';
import type { Draft, DraftPoint } from './plan/draft';
import { legText, type Preview } from './preview';

export interface ListedDraft {
  draft: Draft;
  edits: 'points' | 'fence';
  chosen: number | null;
  preview: Preview | null;
  missionSpeed: number | undefined;
}
export interface ListActions {
  choose(index: number): void;
  setPoint(index: number, part: Partial<DraftPoint>): void;
  setCorner(index: number, at: [number, number]): void;
  remove(index: number): void;
}

export class DraftList {
  private readonly list = byId('draft-list');
  private shown = '';

  constructor(private readonly actions: ListActions) {}

  show(listed: ListedDraft): void {
    const { draft, edits, chosen, preview } = listed;
    const look = `${draft.revision} ${edits} ${draft.mission}`;
    if (look !== this.shown) {
      const focused = document.activeElement?.id ?? '';
      const rows = edits === 'points' ? this.points(listed) : this.corners(draft);
      if (!arrange(this.list, rows)) return;
      this.shown = look;
      if (focused.startsWith('draft-row-')) document.getElementById(focused)?.focus();
    }
    [...this.list.children].forEach((row, i) => {
      mark(row as HTMLElement, 'chosen', String(i === chosen));
      row.querySelector('.pick')?.setAttribute('aria-pressed', String(i === chosen));
      const leg = row.querySelector<HTMLElement>('.leg');
      const told = preview?.legs[i];
      if (!leg) return;
      say(leg, preview && told ? legText(told, preview.clearance) : '');
      mark(row as HTMLElement, 'way', told ? String(told.way.length > 0) : '');
    });
  }

  private points({ draft, missionSpeed }: ListedDraft): HTMLElement[] {
    return draft.points.map((point, i) => {
      const name = `Point ${i + 1}`;
      const { at, depth, altitude, speed } = point;
      const set = (part: Partial<DraftPoint>) => this.actions.setPoint(i, part);
      const below = altitude === undefined;
      const kind = make(
        'select',
        { id: `draft-row-${i}-kind`, 'aria-label': `${name}: depth, or altitude above the bottom` },
        make('option', { value: 'depth', selected: below }, 'depth'),
        make('option', { value: 'altitude', selected: !below }, 'altitude'),
      );
      kind.addEventListener('change', () => set({ altitude: kind.value === 'altitude' ? (altitude ?? 5) : undefined }));
      return this.row(i, name, [
        this.number(i, 'north', 'N', at[0], `${name}: metres north`, (value) => set({ at: [value, at[1]] })),
        this.number(i, 'east', 'E', at[1], `${name}: metres east`, (value) => set({ at: [at[0], value] })),
        kind,
        this.number(i, 'down', 'm', altitude ?? depth, `${name}: ${below ? 'depth' : 'altitude'} in metres`, (value) =>
          set(below ? { depth: value } : { altitude: value }),
        ),
        this.speed(i, `${name}: speed in m/s; empty: that of the mission`, speed, missionSpeed, (value) => set({ speed: value })),
      ]);
    });
  }

  private corners(draft: Draft): HTMLElement[] {
    return draft.fence.map((at, i) => {
      const name = `Corner ${i + 1}`;
      return this.row(i, name, [
        this.number(i, 'north', 'N', at[0], `${name}: metres north`, (value) => this.actions.setCorner(i, [value, at[1]])),
        this.number(i, 'east', 'E', at[1], `${name}: metres east`, (value) => this.actions.setCorner(i, [at[0], value])),
      ]);
    });
  }

  private row(index: number, name: string, fields: HTMLElement[]): HTMLElement {
    const pick = make('button', { type: 'button', class: 'pick', id: `draft-row-${index}-pick`, 'aria-label': name, 'aria-pressed': 'false' }, String(index + 1));
    pick.addEventListener('click', () => this.actions.choose(index));
    const remove = make('button', { type: 'button', id: `draft-row-${index}-delete`, 'aria-label': `Delete ${name.toLowerCase()}` }, 'Delete');
    remove.addEventListener('click', () => this.actions.remove(index));
    return make('li', { 'data-row': index }, make('div', { class: 'fields' }, pick, ...fields, remove), make('span', { class: 'leg' }));
  }

  /** Empty, it shows the speed of the mission. */
  private speed(index: number, title: string, value: number, usual: number | undefined, set: (value: number) => void): HTMLElement {
    const input = make('input', {
      type: 'number',
      id: `draft-row-${index}-speed`,
      step: 0.1,
      min: 0,
      'aria-label': title,
      title,
      value: value > 0 ? String(value) : '',
      placeholder: usual === undefined ? '' : String(usual),
    });
    input.addEventListener('change', () => set(Math.max(0, input.valueAsNumber || 0)));
    return make('label', {}, input, ' m/s');
  }

  private number(index: number, what: string, text: string, value: number, title: string, set: (value: number) => void): HTMLElement {
    const input = make('input', {
      type: 'number',
      id: `draft-row-${index}-${what}`,
      step: what === 'north' || what === 'east' ? 1 : 0.1,
      'aria-label': title,
      title,
      value: String(Math.round(value * 100) / 100),
    });
    input.addEventListener('change', () => {
      const read = input.valueAsNumber;
      if (Number.isFinite(read)) set(read);
      else input.value = String(value);
    });
    return text === 'm' ? make('label', {}, input, ' m') : make('label', {}, `${text} `, input);
  }
}
