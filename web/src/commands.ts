/**
 * Commands: the buttons hold, resume, acknowledge and abort. They need the token of the program; abort needs a second press.
 *
 * The buttons appear above all views as soon as this page may command. A button without effect in the current phase of
 * the mission is disabled. The pressed command is shown until the mission has followed it.
 */
import { toast } from './connection';
import { byId, make, mark, say } from './dom';
import { Kind } from './protocol';
import type { Shared, View } from './view';

/** ms: abort must be pressed again within this time. */
const kSure = 4000;
/** ms: a command without effect is no longer shown as pending after this time. */
const kFollowed = 10000;

type Command = 'hold' | 'resume' | 'acknowledge' | 'abort';

export class Commands implements View {
  private readonly section = byId('commands');
  private readonly bar = byId('command-bar');
  private readonly state = byId('command-state');
  private readonly token = byId<HTMLInputElement>('command-token');
  private readonly buttons = {
    hold: byId<HTMLButtonElement>('command-hold'),
    resume: byId<HTMLButtonElement>('command-resume'),
    acknowledge: byId<HTMLButtonElement>('command-acknowledge'),
    abort: byId<HTMLButtonElement>('command-abort'),
  };
  private drawn = '';
  private armed = 0;
  private ordered: { command: Command; state: string; refusals: number; until: number } | null = null;

  constructor(private readonly shared: Shared) {
    byId<HTMLFormElement>('command-form').addEventListener('submit', (event) => {
      event.preventDefault();
      shared.ask({ ask: 'control', token: this.token.value });
      this.token.value = '';
    });
    for (const command of ['hold', 'resume', 'acknowledge'] as const) {
      this.buttons[command].addEventListener('click', () => this.order(command));
    }
    const { abort } = this.buttons;
    abort.addEventListener('click', () => {
      window.clearTimeout(this.armed);
      if (abort.dataset.armed === 'true') {
        this.order('abort');
        this.disarm();
      } else {
        abort.dataset.armed = 'true';
        say(abort, 'Press again');
        this.armed = window.setTimeout(() => this.disarm(), kSure);
      }
    });
  }

  private order(command: Command): void {
    const { model } = this.shared;
    this.shared.ask({ ask: 'command', command });
    const refusals = model.revision[Kind.refusal]!;
    this.ordered = { command, state: this.stateFor(command), refusals, until: performance.now() + kFollowed };
    this.shared.redraw();
  }

  private disarm(): void {
    this.buttons.abort.dataset.armed = 'false';
    this.buttons.abort.replaceChildren(make('span', {}, 'Abort'));
  }

  private get phase(): string {
    return this.shared.model.way?.phase ?? '';
  }

  private get alarms(): readonly string[] {
    return this.shared.model.health?.alarms ?? [];
  }
  /** What changes when the vehicle follows the command. */
  private stateFor(command: Command): string {
    return command === 'acknowledge' ? this.alarms.join() : this.phase;
  }

  frame(): void {
    const { clock, revision } = this.shared.model;
    const { ordered } = this;
    const followed =
      ordered && (this.stateFor(ordered.command) !== ordered.state || revision[Kind.refusal] !== ordered.refusals);
    if (followed || performance.now() > (ordered?.until ?? Infinity)) this.ordered = null;
    const unseen = this.alarms.some((alarm) => /not acknowledged/.test(alarm));
    const look = `${clock?.control} ${clock?.live} ${this.phase} ${this.ordered?.command} ${unseen}`;
    if (look === this.drawn) return;
    this.drawn = look;
    const may = clock?.control === true;
    if (may && this.bar.hidden) toast('This page may command the mission now.');
    this.section.hidden = clock?.control === undefined;
    byId('command-form').hidden = may;
    byId('command-granted').hidden = !may;
    this.bar.hidden = !may;
    mark(this.bar, 'phase', this.phase);
    say(this.state, this.words(clock?.live ?? false));
    // While the past is shown, its phase does not tell which commands are possible now.
    const now = clock?.live ? this.phase : '';
    this.buttons.hold.disabled = now !== '' && now !== 'under way';
    this.buttons.resume.disabled = now !== '' && now !== 'holding';
    this.buttons.acknowledge.disabled = clock?.live === true && !unseen;
    this.buttons.abort.disabled = now === 'finished' || now === 'aborted';
  }

  private words(live: boolean): string {
    if (this.ordered) return `${kDoing[this.ordered.command]} …`;
    if (!live) return 'The past is shown; commands act on the present';
    return this.phase ? `Mission ${this.phase}` : 'No mission';
  }
}

const kDoing: Record<Command, string> = {
  hold: 'Hold requested',
  resume: 'Resume requested',
  acknowledge: 'Acknowledgement sent',
  abort: 'Abort requested',
};
