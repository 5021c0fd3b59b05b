/**
 * Player: plays a recording, which is a list of blocks of records, each with its time. It answers the same requests as
 * the program and sends a clock as the program does, so that the views need no distinction.
 *
 * A seek starts at the last complete set before the moment and sends the newest version of each item once.
 */
import { kHead, kLastKind, Kind, padded } from './protocol';
import { joined, jsonBytes, writeRecord } from './record_writer';
import type { Request } from './request';

const kBlockHead = 16;

export interface Block {
  ns: bigint;
  /** s since the first block */
  at: number;
  records: Uint8Array;
  /** Contains a record that makes the page forget everything, so that a seek can start here. */
  whole: boolean;
}

/** Reads the complete blocks; an incomplete block, or records that do not fit, end the list. */
export function readBlocks(bytes: Uint8Array): Block[] {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const blocks: Block[] = [];
  let at = 0;
  while (bytes.length - at >= kBlockHead) {
    const ns = view.getBigInt64(at, true);
    const size = view.getUint32(at + 8, true);
    if (view.getUint32(at + 12, true) !== 0 || size > bytes.length - at - kBlockHead) break;
    const records = bytes.subarray(at + kBlockHead, at + kBlockHead + size);
    let whole = false;
    each(records, (_key, from) => (whole ||= (records[from + 1]! & 2) !== 0));
    blocks.push({ ns, at: Number(ns - (blocks[0]?.ns ?? ns)) / 1e9, records, whole });
    at += kBlockHead + size;
  }
  return blocks;
}

/** Calls `take` with the key (kind and number) and the byte range of each record. */
export function each(records: Uint8Array, take: (key: string, from: number, to: number) => void): void {
  const view = new DataView(records.buffer, records.byteOffset, records.byteLength);
  for (let at = 0; records.length - at >= kHead;) {
    const end = at + kHead + padded(view.getUint32(at + 4, true));
    const kind = view.getUint8(at);
    if (kind < 1 || kind > kLastKind || end > records.length) return;
    take(`${kind}:${view.getUint32(at + 12, true)}:${view.getUint32(at + 8, true)}`, at, end);
    at = end;
  }
}

export class Player {
  playing = false;
  speed = 1;
  /** s since the first block */
  now = 0;
  private next = 0;

  constructor(
    private readonly blocks: readonly Block[],
    /** Present end, s: before the last block while a run still grows. */
    public end: number = blocks.at(-1)?.at ?? 0,
    private readonly more: () => object = () => ({}),
  ) {}

  /** Advances by `seconds` and returns the new records; null: it is paused. */
  advance(seconds: number): Uint8Array | null {
    if (!this.playing) return null;
    this.now = Math.min(this.end, this.now + seconds * this.speed);
    if (this.now >= this.end && !this.grows) this.playing = false;
    return this.upTo(this.now);
  }
  grows = false;

  /** The complete set of items at a moment. */
  seek(to: number): Uint8Array {
    this.now = Math.min(this.end, Math.max(0, to));
    const last = this.indexAfter(this.now);
    let first = last - 1;
    while (first > 0 && !this.blocks[first]!.whole) --first;
    const newest = new Map<string, Uint8Array>();
    for (let i = Math.max(0, first); i < last; ++i) {
      const { records } = this.blocks[i]!;
      each(records, (key, from, to) => {
        if ((records[from + 1]! & 2) !== 0) newest.clear();
        newest.delete(key);
        if ((records[from + 1]! & 1) === 0) newest.set(key, records.subarray(from, to));
      });
    }
    this.next = last;
    const all = joined([...newest.values(), this.clock()]);
    for (let at = 0, view = new DataView(all.buffer); at < all.length;) {
      all[at + 1] = at === 0 ? 2 : all[at + 1]! & ~2;
      at += kHead + padded(view.getUint32(at + 4, true));
    }
    return all;
  }

  /** Follows a request; null: a recording cannot do it. */
  ask(request: Request): Uint8Array | null {
    switch (request.ask) {
      case 'play':
        this.playing = true;
        return this.now >= this.end && !this.grows ? this.seek(0) : this.clock();
      case 'pause':
        this.playing = false;
        return this.clock();
      case 'speed':
        this.speed = Math.min(100, Math.max(0.1, request.times));
        return this.clock();
      case 'seek':
        return this.seek(request.to_s);
      case 'step': {
        this.playing = false;
        const at = Math.min(this.blocks.length - 1, Math.max(0, this.indexAfter(this.now) - 1 + request.steps));
        const to = this.blocks[at]?.at ?? 0;
        return request.steps > 0 ? ((this.now = Math.min(to, this.end)), this.upTo(this.now)) : this.seek(to);
      }
      default:
        return null;
    }
  }

  private upTo(now: number): Uint8Array {
    const last = this.indexAfter(now);
    const parts = this.blocks.slice(this.next, last).map((block) => block.records);
    this.next = last;
    return joined([...parts, this.clock()]);
  }

  /** Index of the first block that is later than `now`. */
  private indexAfter(now: number): number {
    let [low, high] = [0, this.blocks.length];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.blocks[middle]!.at <= now + 1e-9) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  private clock(): Uint8Array {
    const { now, end, playing, speed } = this;
    const told = { now_s: now, start_s: 0, end_s: end, live: false, playing, speed, ...this.more() };
    const ns = (this.blocks[0]?.ns ?? 0n) + BigInt(Math.round(now * 1e9));
    return writeRecord({ kind: Kind.clock, time: ns, payload: jsonBytes(told) });
  }
}
