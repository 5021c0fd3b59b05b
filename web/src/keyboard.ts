/** Keyboard shortcuts of the page. Keys that are typed into a field have no other effect. */
import { byId } from './dom';
import { KeptChoices } from './kept';
import { views, type Layout } from './layout';
import type { PlanView } from './plan/plan';
import type { SpaceView } from './space/space';
import type { Theme } from './theme';
import type { Timeline } from './timeline';
import type { Shared } from './view';

export interface Parts {
  shared: Shared;
  layout: Layout;
  plan: PlanView;
  space: SpaceView;
  timeline: Timeline;
  theme: Theme;
}

export function listenToKeys(parts: Parts): void {
  const help = byId<HTMLDialogElement>('help');
  const keys = byId<HTMLInputElement>('keys-on');
  new KeptChoices('isobath-keys', [keys]);
  byId('help-button').addEventListener('click', () => help.showModal());
  byId('help-close').addEventListener('click', () => help.close());
  help.addEventListener('click', (event) => event.target === help && help.close());
  window.addEventListener('keydown', (event) => {
    const target = event.target as HTMLElement;
    if (event.ctrlKey || event.metaKey || event.altKey || document.querySelector('dialog[open]')) return;
    if (target.matches('input:not([type=checkbox]), select, textarea')) return;
    if (moveAmongTabs(event, target)) return event.preventDefault();
    // The space key presses a focused button, as everywhere.
    if (event.key === ' ' && target.matches('button, summary, input')) return;
    if (!keys.checked && event.key.length === 1 && event.key !== ' ') return;
    if (act(event, parts, help)) event.preventDefault();
  });
}

/** Arrow keys, Home and End on a tab go to another one, as in every list of tabs; they never seek in time. */
function moveAmongTabs({ key }: KeyboardEvent, target: HTMLElement): boolean {
  const list = target.closest('[role=tab]')?.closest('[role=tablist]');
  if (!list || !['ArrowLeft', 'ArrowRight', 'ArrowUp', 'ArrowDown', 'Home', 'End'].includes(key)) return false;
  const tabs = [...list.querySelectorAll<HTMLElement>('[role=tab]')];
  const at = tabs.indexOf(target.closest<HTMLElement>('[role=tab]')!);
  const step = key === 'ArrowRight' ? 1 : key === 'ArrowLeft' ? -1 : 0;
  const to = key === 'Home' ? 0 : key === 'End' ? tabs.length - 1 : (at + step + tabs.length) % tabs.length;
  tabs[to]?.focus();
  if (to !== at) tabs[to]?.click();
  return true;
}

function act(event: KeyboardEvent, parts: Parts, help: HTMLDialogElement): boolean {
  const { shared, layout, plan, space, timeline, theme } = parts;
  const inSpace = layout.view === 'space';
  switch (event.key) {
    case ' ':
      timeline.toggle();
      return true;
    case 'ArrowLeft':
    case 'ArrowRight':
    case 'ArrowUp':
    case 'ArrowDown':
      return arrow(event, parts, inSpace);
    case '+':
    case '=':
      (inSpace ? space : plan).zoomBy(1.4);
      return true;
    case '-':
    case '_':
      (inSpace ? space : plan).zoomBy(1 / 1.4);
      return true;
    case 'f':
      inSpace ? space.follow() : plan.toggleFollow();
      return true;
    case 'u':
      plan.turnUp();
      return true;
    case 'v':
      if (inSpace) space.lookDown();
      return inSpace;
    case 'p':
      plan.togglePredicted();
      return true;
    case 'r':
      plan.measure(!plan.isMeasuring);
      return true;
    case 'a':
      if (inSpace) space.panBy(-1, 0);
      else plan.showAll();
      return true;
    case 'w':
      if (inSpace) space.panBy(0, 1);
      return inSpace;
    case 's':
      if (inSpace) space.panBy(0, -1);
      return inSpace;
    case 'd':
      if (inSpace) space.panBy(1, 0);
      return inSpace;
    case 'l':
      timeline.goLive();
      return true;
    case 'n':
      theme.toggle();
      return true;
    case 'e':
      layout.enlarge(document.body.dataset.large !== 'upper');
      return true;
    case '?':
      help.showModal();
      return true;
    case 'Escape':
      plan.measure(false);
      shared.selected = null;
      shared.pointedDecision = null;
      shared.obstacle = null;
      shared.redraw();
      return true;
    default: {
      const view = views[Number(event.key) - 1];
      if (view) layout.show(view);
      return view !== undefined;
    }
  }
}

function arrow(event: KeyboardEvent, { shared, plan, space }: Parts, inSpace: boolean): boolean {
  const right = event.key === 'ArrowRight' ? 1 : event.key === 'ArrowLeft' ? -1 : 0;
  const up = event.key === 'ArrowUp' ? 1 : event.key === 'ArrowDown' ? -1 : 0;
  if (event.shiftKey) {
    if (inSpace) space.turnBy(right, up);
    else plan.panBy(right, up);
    return true;
  }
  if (right === 0) return false;
  shared.ask({ ask: 'step', steps: right });
  return true;
}
