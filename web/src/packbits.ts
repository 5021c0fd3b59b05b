/**
 * Unpacks PackBits: a head byte h of 0..127 is followed by h + 1 literal bytes, h of 129..255 by one byte that is
 * repeated 257 - h times; 128 is skipped.
 *
 * Returns false unless `packed` is used up exactly and fills `out` exactly: such a record is damaged. Never reads or
 * writes beyond either array.
 */
export function unpackBits(packed: Uint8Array, out: Uint8Array): boolean {
  let from = 0;
  let to = 0;
  while (from < packed.length) {
    const head = packed[from++]!;
    if (head === 128) continue;
    if (head < 128) {
      const count = head + 1;
      if (from + count > packed.length || to + count > out.length) return false;
      out.set(packed.subarray(from, from + count), to);
      from += count;
      to += count;
    } else {
      const count = 257 - head;
      if (from >= packed.length || to + count > out.length) return false;
      out.fill(packed[from++]!, to, to + count);
      to += count;
    }
  }
  return to === out.length;
}
