import { describe, expect, it } from 'vitest';
import { levelNote, readLevels } from '../src/levels';

const helm = {
  level: 'primitive',
  command: 'heading 5 deg, depth 12.0 m, 1.50 m/s',
  by: 'pilot',
  since_ns: 2_500_000_000,
  number: 12,
  parent: 9,
};

describe('levels', () => {
  it('say who commands what, and since when', () => {
    const [level] = readLevels([helm])!;
    expect(level).toEqual({
      level: 'primitive',
      command: helm.command,
      by: 'pilot',
      since: 2.5,
      serves: true,
      horizon: 0,
      plan: '',
    });
    expect(levelNote(level!, '3 s')).toBe('pilot, for 3 s');
    expect(levelNote(readLevels([{ ...helm, parent: 0 }])![0]!, '')).toBe('pilot, a reflex or a stop');
  });

  it('say how far ahead they plan, and where in a plan graph the vehicle is', () => {
    const [level] = readLevels([{ ...helm, level: 'vehicle', horizon_s: 299.6, plan: '"point 1" (node 1 of 9)' }])!;
    expect(levelNote(level!, '3 s')).toBe('pilot, for 3 s; plans 300 s ahead');
    expect(level!.plan).toBe('"point 1" (node 1 of 9)');
  });

  it('are left out where they are no levels', () => {
    expect(readLevels({})).toBeNull();
    expect(readLevels([{ ...helm, by: '' }, 7, helm])).toHaveLength(1);
  });
});
