/**
 * Commands: the buttons hold, resume, acknowledge, return and abort, and who has command. They need the token of the
 * program; return and abort need a second press.
 *
 * The buttons appear above all views as soon as this page may command. A button without effect in the current phase of
 * the mission is disabled. The pressed command is shown until the mission has followed it.
 */
import { toast } from './connection';
import { byId, make, mark, say } from './dom';
import { Kind } from './protocol';
import * as units from './units';
import type { Shared, View } from './view';

/** ms: abort must be pressed again within this time. */
const kSure = 4000;
/** ms: a command without effect is no longer shown as pending after this time. */
const kFollowed = 10000;

type Command = 'hold' | 'resume' | 'acknowledge' | 'return' | 'abort';

export class Commands implements View {
  private readonly section = byId('commands');
  private readonly bar = byId('command-bar');
  private readonly state = byId('command-state');
  private readonly token = byId<HTMLInputElement>('command-token');
  private readonly buttons = {
    hold: byId<HTMLButtonElement>('command-hold'),
    resume: byId<HTMLButtonElement>('command-resume'),
    acknowledge: byId<HTMLButtonElement>('command-acknowledge'),
    return: byId<HTMLButtonElement>('command-return'),
    abort: byId<HTMLButtonElement>('command-abort'),
  };
  private drawn = '';
  private ordered: { command: Command; state: string; refusals: number; until: number } | null = null;

  constructor(
    private readonly shared: Shared,
    openHealth: () => void,
  ) {
    byId<HTMLFormElement>('command-form').addEventListener('submit', (event) => {
      event.preventDefault();
      shared.ask({ ask: 'control', token: this.token.value });
      this.token.value = '';
    });
    for (const command of ['hold', 'resume', 'acknowledge'] as const) {
      this.buttons[command].addEventListener('click', () => this.order(command));
    }
    for (const command of ['return', 'abort'] as const) this.armFirst(command);
    byId('command-release').addEventListener('click', () => shared.ask({ ask: 'release' }));
    byId('commander-take').addEventListener('click', () => {
      openHealth();
      this.token.focus();
    });
  }

  /** The first press arms the button, the second orders. */
  private armFirst(command: 'return' | 'abort'): void {
    const button = this.buttons[command];
    const name = command === 'abort' ? 'Abort' : 'Return';
    let armed = 0;
    const disarm = () => {
      button.dataset.armed = 'false';
      button.replaceChildren(make('span', {}, name));
    };
    button.addEventListener('click', () => {
      window.clearTimeout(armed);
      if (button.dataset.armed === 'true') {
        this.order(command);
        disarm();
      } else {
        button.dataset.armed = 'true';
        say(button, 'Press again');
        armed = window.setTimeout(disarm, kSure);
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

  private get phase(): string {
    return this.shared.model.way?.phase ?? '';
  }

  private get alarms(): readonly string[] {
    return this.shared.model.health?.alarms ?? [];
  }
  /** What changes when the vehicle follows the command. */
  private stateFor(command: Command): string {
    if (command === 'acknowledge') return this.alarms.join();
    return command === 'return' ? String(this.shared.model.scene?.missionNumber) : this.phase;
  }

  frame(): void {
    const { clock, revision } = this.shared.model;
    const { ordered } = this;
    const followed =
      ordered && (this.stateFor(ordered.command) !== ordered.state || revision[Kind.refusal] !== ordered.refusals);
    if (followed || performance.now() > (ordered?.until ?? Infinity)) this.ordered = null;
    const unseen = this.alarms.some((alarm) => /not acknowledged/.test(alarm));
    const { by, since } = clock?.command ?? { by: '', since: 0 };
    const look = `${clock?.control} ${clock?.live} ${this.phase} ${this.ordered?.command} ${unseen} ${by} ${since}`;
    if (look === this.drawn) return;
    this.drawn = look;
    const may = clock?.control === true;
    if (may && this.bar.hidden) toast('This page may command the mission now.');
    if (!may && !this.bar.hidden && by) toast(`This page has lost command: ${by} has it now.`);
    this.tellCommander(!may && by !== '' && clock?.control !== undefined, by, since);
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
    this.buttons.return.disabled = clock?.live !== true || clock.over || now === '' || now === 'waiting';
  }

  /** On the pages without command: who has it. */
  private tellCommander(there: boolean, by: string, since: number): void {
    byId('commander-bar').hidden = !there;
    say(byId('commander'), there ? `${by.charAt(0).toUpperCase()}${by.slice(1)} has command since ${units.elapsed(since, 0)}` : '');
  }

  private words(live: boolean): string {
    if (this.ordered) return `${kDoing[this.ordered.command]} …`;
    if (!live) return 'The past is shown; commands act on the present';
    return `You have command. ${this.phase ? `Mission ${this.phase}` : 'No mission'}`;
  }
}

const kDoing: Record<Command, string> = {
  hold: 'Hold requested',
  resume: 'Resume requested',
  acknowledge: 'Acknowledgement sent',
  return: 'Return requested',
  abort: 'Abort requested',
};
