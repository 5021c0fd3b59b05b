/**
 * Feed: the source of records and the target of requests. It is the program's socket, or a run stored in the page.
 */
import { marksOf, type Marks } from './marks';
import { Player, readBlocks } from './player';
import type { Request } from './request';

export type FeedState =
  | { is: 'connecting' }
  | { is: 'open' }
  /** `retry`: time of the next attempt, ms on the feed's clock. `full`: the program serves as many pages as it may. */
  | { is: 'lost'; retry: number; full: boolean }
  | { is: 'stored' }
  | { is: 'unreadable'; why: string };

export interface Feed {
  readonly state: FeedState;
  /** Time of the last message, ms of performance.now(); NaN: none yet. */
  readonly heard: number;
  readonly bytes: number;
  /** The marks of a stored run on the time line, known before it is played. */
  readonly marks?: Marks | null;
  start(take: (records: Uint8Array) => void, changed: () => void): void;
  /** Sends a request. False: not connected. */
  ask(request: Request): boolean;
}

/** The part of a WebSocket that is used here. */
export interface Socket {
  binaryType: string;
  readyState: number;
  onopen: ((event: never) => unknown) | null;
  onclose: ((event: never) => unknown) | null;
  onmessage: ((event: never) => unknown) | null;
  send(text: string): void;
  close(): void;
}
export interface Surroundings {
  connect(): Socket;
  now(): number;
  later(ms: number, then: () => void): void;
}

const kOpen = 1;
/** The code of RFC 6455 with which the program closes a socket too many. */
const kTryLater = 1013;
const kFirstWait = 500;
const kLongestWait = 15000;
/** ms: a connection that neither opens nor fails is given up after this time. */
const kPatience = 10000;

/** Reconnects by itself. The wait doubles with each attempt; `state` tells the time of the next one. */
export class SocketFeed implements Feed {
  state: FeedState = { is: 'connecting' };
  heard = NaN;
  bytes = 0;
  private socket: Socket | null = null;
  private wait = kFirstWait;
  private take: (records: Uint8Array) => void = () => {};
  private changed: () => void = () => {};

  constructor(private readonly around: Surroundings) {}

  start(take: (records: Uint8Array) => void, changed: () => void): void {
    this.take = take;
    this.changed = changed;
    this.connect();
  }

  ask(request: Request): boolean {
    if (!this.socket || this.socket.readyState !== kOpen) return false;
    this.socket.send(JSON.stringify(request));
    return true;
  }

  private connect(): void {
    this.become({ is: 'connecting' });
    let socket: Socket;
    try {
      socket = this.around.connect();
    } catch {
      return this.lose();
    }
    this.socket = socket;
    socket.binaryType = 'arraybuffer';
    socket.onopen = () => socket === this.socket && this.become({ is: 'open' });
    socket.onmessage = ({ data }: { data: unknown }) => {
      if (!(data instanceof ArrayBuffer) || socket !== this.socket) return;
      this.wait = kFirstWait; // reset by a message only: a socket that opens and sends nothing keeps the longer wait
      this.heard = this.around.now();
      this.bytes += data.byteLength;
      this.take(new Uint8Array(data));
    };
    socket.onclose = (event: { code?: number }) => socket === this.socket && this.lose(event?.code === kTryLater);
    this.around.later(kPatience, () => {
      if (socket !== this.socket || this.state.is !== 'connecting') return;
      this.lose();
      socket.close();
    });
  }

  private lose(full = false): void {
    this.socket = null;
    this.become({ is: 'lost', retry: this.around.now() + this.wait, full });
    this.around.later(this.wait, () => this.connect());
    this.wait = Math.min(kLongestWait, this.wait * 2);
  }

  private become(state: FeedState): void {
    this.state = state;
    this.changed();
  }
}

/** Plays the run that is stored in the page: blocks, plain or compressed by gzip. */
export class StoredFeed implements Feed {
  state: FeedState = { is: 'stored' };
  heard = NaN;
  bytes = 0;
  marks: Marks | null = null;
  private player: Player | null = null;
  private take: (records: Uint8Array) => void = () => {};
  private last = 0;

  constructor(private readonly base64: string) {}

  start(take: (records: Uint8Array) => void, changed: () => void): void {
    this.take = take;
    unpack(this.base64)
      .then((bytes) => {
        const blocks = readBlocks(bytes);
        if (blocks.length === 0) throw new Error('it holds no whole block');
        this.marks = marksOf(blocks);
        this.player = new Player(blocks);
        this.give(this.player.seek(this.player.end)); // show the result first; `play` starts at the beginning
        this.run(performance.now());
      })
      .catch((error: unknown) => {
        this.state = { is: 'unreadable', why: error instanceof Error ? error.message : String(error) };
        changed();
      });
  }

  ask(request: Request): boolean {
    const records = this.player?.ask(request) ?? null;
    if (records) this.give(records);
    return records !== null;
  }

  private readonly run = (now: number): void => {
    const passed = Math.min(0.25, (now - this.last) / 1000);
    this.last = now;
    const records = this.player?.advance(passed) ?? null;
    if (records) this.give(records);
    requestAnimationFrame(this.run);
  };

  private give(records: Uint8Array): void {
    this.heard = performance.now();
    this.bytes += records.length;
    this.take(records);
  }
}

async function unpack(base64: string): Promise<Uint8Array> {
  const text = atob(base64.replace(/\s+/g, ''));
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  if (bytes[0] !== 0x1f || bytes[1] !== 0x8b) return bytes;
  const plain = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'));
  return new Uint8Array(await new Response(plain).arrayBuffer());
}

/** The feed of this document. */
export function feedOf(document: Document): Feed {
  const stored = document.getElementById('isobath-recording')?.textContent?.trim();
  if (stored) return new StoredFeed(stored);
  const { protocol, host, pathname } = document.location;
  return new SocketFeed({
    connect: () => new WebSocket(`${protocol === 'https:' ? 'wss' : 'ws'}://${host}${pathname.replace(/[^/]*$/, '')}socket/paced`),
    now: () => performance.now(),
    later: (ms, then) => void setTimeout(then, ms),
  });
}
