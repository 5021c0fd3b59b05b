/** Layout: the visible views; all at once on a large screen, one at a time on a phone. */
import { byId } from './dom';

export const views = ['plan', 'sonar', 'space', 'log', 'health', 'obstacles', 'plots'] as const;
export type ViewName = (typeof views)[number];

export class Layout {
  view: ViewName = 'plan';
  private upper: ViewName = 'sonar';
  private lower: ViewName = 'log';

  constructor(private readonly changed: () => void) {
    for (const button of document.querySelectorAll<HTMLButtonElement>('[data-show]')) {
      button.addEventListener('click', () => this.show(button.dataset.show as ViewName));
    }
    byId('enlarge').addEventListener('click', () => this.enlarge(document.body.dataset.large !== 'upper'));
    window.addEventListener('resize', changed);
    this.apply();
  }

  show(view: ViewName): void {
    this.view = view;
    if (view === 'sonar' || view === 'space') this.upper = view;
    if (view === 'log' || view === 'obstacles' || view === 'health' || view === 'plots') this.lower = view;
    if (view === 'plan') document.body.dataset.large = 'plan';
    this.apply();
  }

  /** Swaps the places of the upper panel and the chart, or swaps them back. */
  enlarge(on: boolean): void {
    document.body.dataset.large = on ? 'upper' : 'plan';
    byId('enlarge').setAttribute('aria-pressed', String(on));
    this.changed();
  }

  private apply(): void {
    const { dataset } = document.body;
    dataset.view = this.view;
    dataset.upper = this.upper;
    dataset.lower = this.lower;
    for (const button of document.querySelectorAll<HTMLButtonElement>('[data-show]')) {
      const name = button.dataset.show as ViewName;
      const phone = button.closest('#tabs') !== null;
      const on = phone ? name === this.view : name === this.upper || name === this.lower;
      button.setAttribute('aria-selected', String(on));
      button.tabIndex = on ? 0 : -1;
    }
    this.changed();
  }
}
