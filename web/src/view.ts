/** Shared: what all views share. View: the interface of a view. */
import type { Decision } from './items';
import type { Link } from './link';
import type { Model } from './model';
import type { Request } from './request';
import type { Theme } from './theme';

export interface Shared {
  model: Model;
  theme: Theme;
  link: Link;
  ask(request: Request): void;
  /** Requests all voxels, or only their larger cubes. False: not connected. */
  wantVoxels(all: boolean): boolean;
  /** Draws at the next frame, even without a new record. */
  redraw(): void;
  /** Opens a view, pans to the decision and marks it. */
  showDecision(decision: Decision): void;
  selected: Decision | null;
  /** Shows a decision on the chart while the log points at it. */
  pointAt(decision: Decision | null): void;
  pointedDecision: Decision | null;
  /** Pans the chart to an obstacle and marks it; the same one again: no longer. */
  showObstacle(number: number): void;
  /** The number of the selected obstacle. */
  obstacle: number | null;
  /** Marks an obstacle while a list points at it. */
  hover(number: number | null): void;
  hovered: number | null;
}

export interface View {
  /** Called once per frame while something may have changed and the view is visible. */
  frame(now: number): void;
  /** Whether it is visible and has not yet drawn all of the model. */
  readonly behind?: boolean;
}
