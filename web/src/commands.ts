/**
 * Hold, resume or abort, where the program lets this page command: with a token, and abort only on the second press.
 */
import { byId, make, say } from './dom';
import { Kind } from './protocol';
import type { Shared, View } from './view';

const kSure = 4000;

export class Commands implements View {
  private readonly section = byId('commands');
  private readonly token = byId<HTMLInputElement>('command-token');
  private drawn = '';
  private armed = 0;

  constructor(private readonly shared: Shared) {
    byId<HTMLFormElement>('command-form').addEventListener('submit', (event) => {
      event.preventDefault();
      shared.ask({ ask: 'control', token: this.token.value });
      this.token.value = '';
    });
    for (const command of ['hold', 'resume'] as const) {
      byId(`command-${command}`).addEventListener('click', () => shared.ask({ ask: 'command', command }));
    }
    const abort = byId('command-abort');
    abort.addEventListener('click', () => {
      window.clearTimeout(this.armed);
      if (abort.dataset.armed === 'true') {
        shared.ask({ ask: 'command', command: 'abort' });
        this.disarm(abort);
      } else {
        abort.dataset.armed = 'true';
        say(abort, 'Press again to abort');
        this.armed = window.setTimeout(() => this.disarm(abort), kSure);
      }
    });
  }

  private disarm(abort: HTMLElement): void {
    abort.dataset.armed = 'false';
    abort.replaceChildren(make('span', {}, 'Abort'));
  }

  frame(): void {
    const { clock, revision } = this.shared.model;
    const look = `${revision[Kind.clock]}`;
    if (look === this.drawn) return;
    this.drawn = look;
    this.section.hidden = clock?.control === undefined;
    byId('command-form').hidden = clock?.control === true;
    byId('command-buttons').hidden = clock?.control !== true;
  }
}
