"""Makes a PNG of the program small enough for a page: a palette of colours of 4 bits a channel, and half the size if need be."""
import struct
import zlib


def pixels(png):
    """Width and rows of RGB bytes of a PNG as the program writes it: 8 bits, RGB or RGBA, not interlaced."""
    width, height, form = struct.unpack_from(">II5s", png, 16)
    channels = {b"\x08\x02\0\0\0": 3, b"\x08\x06\0\0\0": 4}.get(form)
    if channels is None:
        raise ValueError("not a PNG as isobath writes it")
    at, packed = 8, b""
    while at < len(png):
        size, kind = struct.unpack_from(">I4s", png, at)
        packed += png[at + 8:at + 8 + size] if kind == b"IDAT" else b""
        at += 12 + size
    raw, row, rows = zlib.decompress(packed), bytearray(channels * width), []
    for y in range(height):
        start = y * (channels * width + 1)
        how, above, row = raw[start], row, bytearray(raw[start + 1:start + channels * width + 1])
        for i in range(len(row)):
            a, b, c = row[i - channels] if i >= channels else 0, above[i], above[i - channels] if i >= channels else 0
            paeth = min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2] if how == 4 else 0
            row[i] = (row[i] + (0, a, b, (a + b) // 2, paeth)[how]) & 255
        rows.append(row)
    if channels == 4:
        rows = [bytearray(v for i, v in enumerate(row) if i % 4 != 3) for row in rows]
    return width, rows


def halved(width, rows):
    """Each pixel is the mean of four."""
    half = []
    for a, b in zip(rows[::2], rows[1::2]):
        half.append(bytearray((a[i] + a[i + 3] + b[i] + b[i + 3]) // 4
                              for x in range(width // 2) for i in range(6 * x, 6 * x + 3)))
    return width // 2, half


def packed(width, rows):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    colours, body = {}, bytearray()
    for row in rows:
        body.append(0)
        for r, g, b in zip(*[iter(row)] * 3):
            body.append(colours.setdefault((r >> 4, g >> 4, b >> 4), min(len(colours), 255)))
    palette = bytes(17 * v for colour in list(colours)[:256] for v in colour)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">II5B", width, len(rows), 8, 3, 0, 0, 0)) +
            chunk(b"PLTE", palette) + chunk(b"IDAT", zlib.compress(bytes(body), 9)) + chunk(b"IEND", b""))


def few_colours(rows):
    """The colours, of 4 bits a channel, with the rare ones replaced by the nearest of the 256 most frequent."""
    counts = {}
    for row in rows:
        for r, g, b in zip(*[iter(row)] * 3):
            key = (r >> 4, g >> 4, b >> 4)
            counts[key] = counts.get(key, 0) + 1
    if len(counts) <= 256:
        return rows
    kept = sorted(counts, key=counts.get, reverse=True)[:256]
    near = {c: c if c in kept else min(kept, key=lambda k: sum((x - y) ** 2 for x, y in zip(k, c))) for c in counts}
    return [bytearray(17 * v for r, g, b in zip(*[iter(row)] * 3) for v in near[(r >> 4, g >> 4, b >> 4)]) for row in rows]


def small_png(png, largest=None):
    """The picture in a palette; half as wide and high while it has more than `largest` bytes."""
    width, rows = pixels(png)
    while True:
        data = packed(width, few_colours(rows))
        if largest is None or len(data) <= largest or width < 400:
            return data
        width, rows = halved(width, rows)
