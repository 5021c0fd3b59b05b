import { describe, expect, it } from 'vitest';
import { readSounds, soundText } from '../src/sounds';

const barge = {
  number: 1,
  frequency_hz: 120.04,
  bearing_deg: 90,
  sigma_deg: 2,
  from: [3, -4],
  origin: 'obstacle',
  obstacle: 7,
  probability: 0.99,
  to: [3, 20],
};

describe('sounds', () => {
  it('say which obstacle they come from', () => {
    const [sound] = readSounds([barge])!;
    expect(sound!.bearing).toBeCloseTo(Math.PI / 2);
    expect(sound!.to).toEqual([3, 20]);
    expect(soundText(sound!)).toBe('120 Hz, obstacle 7');
    expect(soundText(readSounds([{ ...barge, origin: 'none', frequency_hz: 63.25 }])![0]!)).toBe(
      '63.3 Hz, no known obstacle',
    );
    expect(soundText(readSounds([{ ...barge, origin: 'unknown', frequency_hz: 1500.4 }])![0]!)).toBe(
      '1500 Hz, origin unknown',
    );
  });

  it('are left out where they have no frequency, place or direction', () => {
    expect(readSounds({})).toBeNull();
    for (const missing of ['frequency_hz', 'from', 'bearing_deg']) {
      expect(readSounds([{ ...barge, [missing]: undefined }, 3, null])).toEqual([]);
    }
  });
});
