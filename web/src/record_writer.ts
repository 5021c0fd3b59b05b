/** Writes records as bytes, for the clock of a stored run and for the fixtures. */
import { kHead, padded } from './protocol';

export interface NewRecord {
  kind: number;
  number?: bigint;
  /** ns since 1970 */
  time: bigint;
  payload?: Uint8Array;
  gone?: boolean;
  forget?: boolean;
  forgetKind?: boolean;
}

export function writeRecord({ kind, number = 0n, time, payload, gone, forget, forgetKind }: NewRecord): Uint8Array {
  const body = gone ? undefined : payload;
  const size = body?.length ?? 0;
  const bytes = new Uint8Array(kHead + padded(size));
  const view = new DataView(bytes.buffer);
  view.setUint8(0, kind);
  view.setUint8(1, (gone ? 1 : 0) | (forget ? 2 : 0) | (forgetKind ? 4 : 0));
  view.setUint32(4, size, true);
  view.setBigUint64(8, BigInt.asUintN(64, number), true);
  view.setBigInt64(16, time, true);
  if (body) bytes.set(body, kHead);
  return bytes;
}

const utf8 = new TextEncoder();
export const jsonBytes = (value: unknown): Uint8Array => utf8.encode(JSON.stringify(value));

export function joined(parts: readonly Uint8Array[]): Uint8Array {
  const all = new Uint8Array(parts.reduce((sum, part) => sum + part.length, 0));
  let at = 0;
  for (const part of parts) {
    all.set(part, at);
    at += part.length;
  }
  return all;
}
