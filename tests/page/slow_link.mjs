// A link between browser and program with a rate and a delay, as of a radio modem: what is sent faster than the rate
// waits in a buffer of the link, so that the sender does not notice. The page itself comes at once, to save the test's time.
import { connect, createServer } from 'node:net';

/** `rate`: bytes a second; `delay`: ms one way; `buffer`: s that bytes may wait. A link can be cut and joined. */
export async function slowLink(port, { rate, delay, buffer = 8 }) {
  const sockets = new Set();
  const link = { cut: false };
  const carry = (from, to, slow) => {
    let free = 0; // when the last byte has been sent, ms
    from.on('data', (bytes) => {
      if (!slow(bytes)) return to.write(bytes);
      const now = performance.now();
      free = Math.max(now, free) + (bytes.length / rate) * 1000;
      setTimeout(() => !to.destroyed && !link.cut && to.write(bytes), free + delay - now);
      if (free - now > buffer * 1000) {
        from.pause();
        setTimeout(() => from.resume(), free - now - buffer * 1000);
      }
    });
    from.on('close', () => to.destroy());
    from.on('error', () => to.destroy());
  };
  const server = createServer({ noDelay: true, highWaterMark: 1400 }, (near) => {
    const far = connect({ port, host: '127.0.0.1', noDelay: true, highWaterMark: 1400 });
    for (const socket of [near, far]) sockets.add(socket);
    let socket = false;
    carry(near, far, (bytes) => (socket ||= bytes.includes('/socket')));
    carry(far, near, () => socket);
  });
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
  link.url = `http://127.0.0.1:${server.address().port}/`;
  link.end = () => {
    for (const socket of sockets) socket.destroy();
    server.close();
  };
  return link;
}
