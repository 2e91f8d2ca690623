"""Pictures: what the tower sends, what the monitor shows, and how they compare."""
import struct
import zlib

BLOCK_PX = 8
NUMBER_BITS = 16
MARK = 1 << (NUMBER_BITS - 1)  # set in every number, so that a black corner is none


class Picture:
    """RGB, 8 bits each, rows packed."""

    def __init__(self, width, height, pixels):
        self.width, self.height, self.pixels = width, height, pixels

    @staticmethod
    def read_ppm(path):
        with open(path, "rb") as file:
            data = file.read()
        fields, at = [], 0
        while len(fields) < 4:
            end = at
            while data[end:end + 1] not in (b" ", b"\n", b"\t"):
                end += 1
            fields.append(data[at:end])
            at = end + 1
        if fields[0] != b"P6" or fields[3] != b"255":
            raise ValueError(f"{path}: not a PPM of 8 bits")
        return Picture(int(fields[1]), int(fields[2]), data[at:])

    def write_png(self, path):
        rows = b"".join(b"\0" + self.row(y) for y in range(self.height))

        def chunk(kind, body):
            return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

        with open(path, "wb") as file:
            file.write(b"\x89PNG\r\n\x1a\n"
                       + chunk(b"IHDR", struct.pack(">IIBBBBB", self.width, self.height, 8, 2, 0, 0, 0))
                       + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))

    def row(self, y):
        return self.pixels[3 * self.width * y:3 * self.width * (y + 1)]

    def at(self, x, y):
        start = 3 * (self.width * y + x)
        return tuple(self.pixels[start:start + 3])

    def number(self):
        """The number that the tower wrote into the bottom left corner, or None."""
        if self.height < BLOCK_PX or self.width < BLOCK_PX * NUMBER_BITS:
            return None
        value = 0
        for bit in range(NUMBER_BITS):
            level = sum(self.at(bit * BLOCK_PX + BLOCK_PX // 2, self.height - BLOCK_PX // 2)) // 3
            if 40 < level < 215:
                return None
            value |= (level >= 215) << bit
        return value & ~MARK if value & MARK else None


class TowerClip:
    """The pictures that the tower sends: YUYV, BT.601, limited range, rows packed."""

    def __init__(self, path, width, height):
        self._path, self.width, self.height = path, width, height

    def rgb(self, number):
        """Picture `number` as it has to look, by the formulas of BT.601."""
        size = self.width * self.height * 2
        with open(self._path, "rb") as file:
            file.seek(number * size)
            yuyv = file.read(size)
        luma = [255 / 219 * (y - 16) for y in range(256)]
        red_v = [255 / 224 * 1.402 * (v - 128) for v in range(256)]
        green_u = [-255 / 224 * 0.114 * 1.772 / 0.587 * (u - 128) for u in range(256)]
        green_v = [-255 / 224 * 0.299 * 1.402 / 0.587 * (v - 128) for v in range(256)]
        blue_u = [255 / 224 * 1.772 * (u - 128) for u in range(256)]
        out = bytearray()
        for y0, u, y1, v in struct.iter_unpack("4B", yuyv):
            for y in (y0, y1):
                for value in (luma[y] + red_v[v], luma[y] + green_u[u] + green_v[v], luma[y] + blue_u[u]):
                    out.append(min(255, max(0, int(value + 0.5))))
        return Picture(self.width, self.height, bytes(out))


def differing_pixels(a, b, tolerance):
    """The (x, y) at which two pictures of the same size differ by more than `tolerance` in some channel."""
    if (a.width, a.height) != (b.width, b.height):
        raise ValueError(f"{a.width}x{a.height} against {b.width}x{b.height}")
    found = []
    for y in range(a.height):
        row_a, row_b = a.row(y), b.row(y)
        if row_a == row_b:
            continue
        for x in range(a.width):
            if any(abs(row_a[3 * x + c] - row_b[3 * x + c]) > tolerance for c in range(3)):
                found.append((x, y))
    return found
