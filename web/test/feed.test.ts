import { afterEach, describe, expect, it, vi } from 'vitest';
import { recording, Demo } from '../fixtures/demo';
import { SocketFeed, StoredFeed, type Socket } from '../src/feed';
import { Model } from '../src/model';
import { marksOf } from '../src/marks';
import { Player, readBlocks } from '../src/player';

/** A program at the other end, and a clock that moves only when told. */
class Harbour {
  now = 0;
  sockets: Socket[] = [];
  sent: string[] = [];
  refuse = false;
  private due: { at: number; then: () => void }[] = [];

  readonly around = {
    connect: (): Socket => {
      if (this.refuse) throw new Error('refused');
      const socket: Socket = {
        binaryType: '',
        readyState: 0,
        onopen: null,
        onclose: null,
        onmessage: null,
        send: (text) => void this.sent.push(text),
        close: () => {},
      };
      this.sockets.push(socket);
      return socket;
    },
    now: () => this.now,
    later: (ms: number, then: () => void) => void this.due.push({ at: this.now + ms, then }),
  };

  get last(): Socket {
    return this.sockets.at(-1)!;
  }
  open(): void {
    this.last.readyState = 1;
    this.last.onopen?.({} as never);
  }
  tell(bytes: Uint8Array): void {
    this.last.onmessage?.({ data: bytes.slice().buffer } as never);
  }
  drop(code?: number): void {
    this.last.readyState = 3;
    this.last.onclose?.({ code } as never);
  }
  pass(ms: number): void {
    const until = this.now + ms;
    for (;;) {
      const next = this.due.filter(({ at }) => at <= until).sort((a, b) => a.at - b.at)[0];
      if (!next) break;
      this.due.splice(this.due.indexOf(next), 1);
      this.now = next.at;
      next.then();
    }
    this.now = until;
  }
}

function started(): { harbour: Harbour; feed: SocketFeed; heard: number[] } {
  const harbour = new Harbour();
  const feed = new SocketFeed(harbour.around);
  const heard: number[] = [];
  feed.start(
    (bytes) => heard.push(bytes.length),
    () => {},
  );
  return { harbour, feed, heard };
}

describe('the socket', () => {
  it('hands on what comes, counts it and knows when', () => {
    const { harbour, feed, heard } = started();
    harbour.open();
    harbour.pass(70);
    harbour.tell(new Uint8Array(24));
    expect(feed.state.is).toBe('open');
    expect(heard).toEqual([24]);
    expect([feed.heard, feed.bytes]).toEqual([70, 24]);
  });

  it('is opened again after twice the wait each time, and says when', () => {
    const { harbour, feed } = started();
    harbour.open();
    const waits: number[] = [];
    for (let k = 0; k < 8; ++k) {
      harbour.drop();
      expect(feed.state.is).toBe('lost');
      waits.push(feed.state.is === 'lost' ? feed.state.retry - harbour.now : NaN);
      harbour.pass(waits.at(-1)!);
      expect(harbour.sockets).toHaveLength(k + 2);
    }
    expect(waits).toEqual([500, 1000, 2000, 4000, 8000, 15000, 15000, 15000]);
  });

  it('begins with short waits again once something was heard', () => {
    const { harbour, feed } = started();
    for (let k = 0; k < 4; ++k) {
      harbour.drop();
      harbour.pass(500 * 2 ** k);
    }
    harbour.open();
    harbour.tell(new Uint8Array(24));
    harbour.drop();
    expect(feed.state).toEqual({ is: 'lost', retry: harbour.now + 500, full: false });
  });

  it('that the program has no place for says so, and tries again', () => {
    const { harbour, feed } = started();
    harbour.drop(1013);
    expect(feed.state).toEqual({ is: 'lost', retry: harbour.now + 500, full: true });
    harbour.pass(500);
    expect(harbour.sockets).toHaveLength(2);
  });

  it('that neither opens nor fails is given up', () => {
    const { harbour, feed } = started();
    harbour.pass(10000);
    expect(feed.state.is).toBe('lost');
    harbour.pass(500);
    expect(harbour.sockets).toHaveLength(2);
  });

  it('that cannot even be made is tried again', () => {
    const harbour = new Harbour();
    harbour.refuse = true;
    const feed = new SocketFeed(harbour.around);
    feed.start(
      () => {},
      () => {},
    );
    expect(feed.state.is).toBe('lost');
    harbour.refuse = false;
    harbour.pass(500);
    expect(harbour.sockets).toHaveLength(1);
  });

  it('asks only while it is open', () => {
    const { harbour, feed } = started();
    expect(feed.ask({ ask: 'play' })).toBe(false);
    harbour.open();
    expect(feed.ask({ ask: 'seek', to_s: 61.5 })).toBe(true);
    expect(harbour.sent).toEqual(['{"ask":"seek","to_s":61.5}']);
  });

  it('hears nothing from one that it gave up', () => {
    const { harbour, heard } = started();
    harbour.open();
    const old = harbour.last;
    harbour.drop();
    harbour.pass(500);
    harbour.open();
    old.onmessage?.({ data: new ArrayBuffer(24) } as never);
    expect(heard).toEqual([]);
  });
});

describe('a recording', () => {
  const bytes = recording(40, new Demo(8, 20));
  const blocks = readBlocks(bytes);

  /** All blocks up to a moment, one after the other: what the page must come to by any way. */
  function plainly(seconds: number): Model {
    const model = new Model();
    for (const { at, records } of blocks) if (at <= seconds + 1e-6) model.take(records);
    return model;
  }
  const essence = (m: Model) => ({
    vehicle: m.vehicle,
    decisions: m.decisions,
    way: m.way,
    obstacles: m.obstacles,
    pieces: m.pieces,
    health: m.health,
    track: [...m.track].map(([k, { places }]) => [k, [...places]]).sort(),
    depth: [...m.depth].map(([k, { item }]) => [k, [...item.confidence]]).sort(),
    echoes: [...m.sonars].map(([k, image]) => [k, [...image.intensity], [...image.heard]]),
  });

  it('is cut into its blocks, and a damaged end costs only that', () => {
    expect(blocks).toHaveLength(400);
    expect(readBlocks(bytes.slice(0, bytes.length - 3))).toHaveLength(399);
    expect(blocks[0]!.whole).toBe(true);
    expect(blocks.slice(1).some(({ whole }) => whole)).toBe(false);
  });

  it('shows the same after a jump as after playing to it', () => {
    for (const to of [0, 7.3, 25.05, 39.9]) {
      const model = new Model();
      const player = new Player(blocks);
      model.take(player.seek(35));
      model.take(player.seek(to));
      const [is, must] = [essence(model), essence(plainly(to))];
      for (const key of Object.keys(is) as (keyof typeof is)[])
        expect([to, key, is[key]]).toEqual([to, key, must[key]]);
      expect(model.clock).toMatchObject({ now: to, start: 0, end: expect.closeTo(39.9, 6) as number, live: false });
    }
  });

  it('plays on from there, at its speed, and stops at its end', () => {
    const model = new Model();
    const player = new Player(blocks);
    model.take(player.seek(10));
    player.ask({ ask: 'speed', times: 4 });
    model.take(player.ask({ ask: 'play' })!);
    for (let k = 0; k < 10; ++k) model.take(player.advance(0.25)!);
    expect(essence(model)).toEqual(essence(plainly(20)));
    while (player.playing) model.take(player.advance(0.25)!);
    expect(essence(model)).toEqual(essence(plainly(40)));
    expect(player.advance(1)).toBeNull();
  });

  it('goes to the next and to the last moment, and pauses', () => {
    const model = new Model();
    const player = new Player(blocks);
    model.take(player.seek(10));
    player.playing = true;
    model.take(player.ask({ ask: 'step', steps: 1 })!);
    expect([model.clock!.now, model.clock!.playing]).toEqual([expect.closeTo(10.1, 6), false]);
    expect(essence(model)).toEqual(essence(plainly(10.1)));
    model.take(player.ask({ ask: 'step', steps: -1 })!);
    model.take(player.ask({ ask: 'step', steps: -1 })!);
    expect(model.clock!.now).toBeCloseTo(9.9, 6);
    expect(essence(model)).toEqual(essence(plainly(9.9)));
  });

  it('is marked before it is played', () => {
    const marks = [...marksOf(blocks).all.values()];
    expect(marks.map(({ at, alarm }) => [Math.round(at * 10) / 10, alarm])).toEqual([
      [0, false],
      [0.3, false],
      [19, false],
    ]);
  });

  it('has no now and no mission to command', () => {
    const player = new Player(blocks);
    expect(player.ask({ ask: 'live' })).toBeNull();
    expect(player.ask({ ask: 'command', command: 'abort' })).toBeNull();
  });
});

describe('a run in the document', () => {
  afterEach(() => vi.unstubAllGlobals());

  /** As far as it has come once it is unpacked. */
  async function opened(base64: string): Promise<{ feed: StoredFeed; model: Model }> {
    vi.stubGlobal('requestAnimationFrame', () => 0);
    const feed = new StoredFeed(base64);
    const model = new Model();
    await new Promise<void>((resolve) => {
      feed.start(
        (records) => {
          model.take(records);
          resolve();
        },
        () => resolve(),
      );
    });
    return { feed, model };
  }
  const bytes = recording(20, new Demo(8, 20));
  const text = Buffer.from(bytes).toString('base64');

  it('shows first what was known at its end, and stands', async () => {
    const { feed, model } = await opened(text);
    expect(feed.state.is).toBe('stored');
    expect(model.clock).toMatchObject({ now: expect.closeTo(19.9, 6) as number, playing: false });
    expect(model.track.size).toBeGreaterThan(0);
  });

  it('plays from its start', async () => {
    const { feed, model } = await opened(text);
    expect(feed.ask({ ask: 'play' })).toBe(true);
    expect(model.clock).toMatchObject({ now: 0, playing: true });
  });

  it('is the same when it is packed', async () => {
    const packed = new Blob([bytes.slice()]).stream().pipeThrough(new CompressionStream('gzip'));
    const gzip = Buffer.from(await new Response(packed).arrayBuffer()).toString('base64');
    const { model } = await opened(gzip);
    expect(model.vehicle).toEqual((await opened(text)).model.vehicle);
  });

  it('that is damaged says so', async () => {
    const { feed } = await opened('AAAA');
    expect(feed.state).toMatchObject({ is: 'unreadable' });
  });
});
