import { describe, expect, it } from 'vitest';
import { partnerNote, readPartner } from '../src/partners';

describe('partners', () => {
  it('are read with the time at which they were heard', () => {
    const partner = readPartner({ at: [12.5, -3], over: false, lane: 4 }, 100);
    expect(partner).toEqual({ at: [12.5, -3], heard: 100, lane: 4, over: false });
    expect(partnerNote('bravo', partner!, '12 s')).toBe('bravo, lane 4, 12 s ago');
  });
  it('are at rest once their mission is over', () => {
    expect(partnerNote('bravo', readPartner({ at: [0, 0], over: true }, 0)!, '')).toBe('bravo, at rest');
  });
  it('are left out where they have no place', () => {
    for (const wrong of [null, [], {}, { at: 'here' }, { at: [1] }]) expect(readPartner(wrong, 0)).toBeNull();
  });
});
