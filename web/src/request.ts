import type { DraftJson } from './plan/draft';

/** A request of the page to its feed. */
export type Request =
  | { ask: 'play' | 'pause' | 'live' }
  | { ask: 'speed'; times: number }
  | { ask: 'seek'; to_s: number }
  | { ask: 'step'; steps: number }
  | { ask: 'control'; token: string }
  | { ask: 'seen'; frame: number }
  | { ask: 'detail'; voxels: 'all' | 'cubes' }
  | { ask: 'command'; command: 'hold' | 'resume' | 'abort' | 'acknowledge' | 'return' }
  | { ask: 'release' }
  | { ask: 'preview' | 'mission'; draft: DraftJson };
