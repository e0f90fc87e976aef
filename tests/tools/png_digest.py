# SPDX-License-Identifier: Apache-2.0
"""Prints the SHA-256 of a PNG's shape and pixels as the manifest of `disparityctl process` defines it, by a decoder of its own.

Usage: png_digest.py FILE (grey of 16 bits, or red, green, blue of 8).
"""
import hashlib
import struct
import sys
import zlib


def chunks(data):
    at = 8
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        yield kind, data[at + 8:at + 8 + size]
        at += 12 + size


def rows(packed, height, size, pixel):
    """Undoes the filters of the rows."""
    raw, above = zlib.decompress(packed), bytearray(size)
    for y in range(height):
        kind, *line = raw[y * (size + 1):(y + 1) * (size + 1)]
        for i in range(size):
            left, corner = (line[i - pixel], above[i - pixel]) if i >= pixel else (0, 0)
            guess = left + above[i] - corner
            nearest = min((left, above[i], corner), key=lambda value: abs(guess - value))  # the first of equals
            line[i] = line[i] + (0, left, above[i], (left + above[i]) // 2, nearest)[kind] & 255
        above = line
        yield bytes(line)


def main():
    with open(sys.argv[1], "rb") as file:
        parts = list(chunks(file.read()))
    width, height, bits, colour = struct.unpack(">IIBB", parts[0][1][:10])
    channels = {0: 1, 2: 3}[colour]
    pixel = bits // 8 * channels
    digest = hashlib.sha256(f"{width} {height} {channels} {bits}\n".encode())
    for row in rows(b"".join(body for kind, body in parts if kind == b"IDAT"), height, width * pixel, pixel):
        digest.update(struct.pack(f"<{width}H", *struct.unpack(f">{width}H", row)) if bits == 16 else row)
    print(digest.hexdigest())


main()
