/** What all views share, and what a view is. */
import type { Decision } from './items';
import type { Model } from './model';
import type { Request } from './request';
import type { Theme } from './theme';

export interface Shared {
  model: Model;
  theme: Theme;
  ask(request: Request): void;
  /** Whether all voxels are to come, or their larger cubes alone. False: nobody was there to be asked. */
  wantVoxels(all: boolean): boolean;
  /** Draw at the next frame, though no record came. */
  redraw(): void;
  /** Opens a view, pans to the decision and marks it. */
  showDecision(decision: Decision): void;
  selected: Decision | null;
}

export interface View {
  /** Called once a frame while something may have changed and the view can be seen. */
  frame(now: number): void;
  /** Whether it can be seen and has still to draw some of what the model holds. */
  readonly behind?: boolean;
}
