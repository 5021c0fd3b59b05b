/**
 * PackedRecords: puts slices of packed records together again. On a slow link, urgent records are sent whole between the
 * slices of bulky ones; each has a channel.
 */
import { unzlibSync } from 'fflate';
import type { Slice } from './protocol';

export class PackedRecords {
  private readonly channels = new Map<number, { bytes: Uint8Array; got: number }>();

  /** The records, once they are whole; null: more is to come. Undefined: the slice does not fit. */
  take(channel: number, { offset, total, bytes }: Slice): Uint8Array | null | undefined {
    if (channel > 1) return undefined;
    if (offset === 0) this.channels.set(channel, { bytes: new Uint8Array(total), got: 0 });
    const packed = this.channels.get(channel);
    if (!packed || packed.got !== offset || packed.bytes.length !== total) return undefined;
    packed.bytes.set(bytes, offset);
    packed.got += bytes.length;
    if (packed.got < total) return null;
    this.channels.delete(channel);
    try {
      return unzlibSync(packed.bytes);
    } catch {
      return undefined;
    }
  }

  clear(): void {
    this.channels.clear();
  }
}
