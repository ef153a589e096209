# SPDX-License-Identifier: MIT OR Apache-2.0
"""Waits until the screen of an Xvfb (its -fbdir file, in the format XWD) shows about the picture of a PPM: as many
colours, and the same mean of red, of green and of blue. Arguments: the screen's file, the PPM, seconds."""

import struct
import sys
import time


def screen(path):
    data = open(path, "rb").read()
    head = struct.unpack(">25I", data[:100])
    size, width, height, bits, line, colours = head[0], head[4], head[5], head[11], head[12], head[19]
    assert bits == 32 and head[14:17] == (0xFF0000, 0xFF00, 0xFF), head
    begin = size + 12 * colours
    rows = [data[begin + y * line : begin + y * line + 4 * width] for y in range(height)]
    order = (2, 1, 0) if head[7] == 0 else (1, 2, 3)
    return [b"".join(row[channel::4] for row in rows) for channel in order]


def picture(path):
    kind, width, height, most, pixels = open(path, "rb").read().split(maxsplit=4)
    assert kind == b"P6" and most == b"255", kind
    # The one white byte after the header may be followed by pixels that look like more.
    pixels = open(path, "rb").read()[-3 * int(width) * int(height) :]
    return [pixels[channel::3] for channel in range(3)]


def summary(planes):
    return len(set(zip(*planes))), [sum(plane) / len(plane) for plane in planes]


wanted_colours, wanted = summary(picture(sys.argv[2]))
assert wanted_colours > 1000 and wanted[0] > 1.2 * wanted[2], (wanted_colours, wanted)
end = time.monotonic() + float(sys.argv[3])
while True:
    colours, mean = summary(screen(sys.argv[1]))
    off = max(abs(a - b) / b for a, b in zip(mean, wanted))
    if colours > wanted_colours / 2 and off < 0.15:
        print("%d colours, mean %s; the picture has %d, %s" % (colours, mean, wanted_colours, wanted))
        sys.exit(0)
    if time.monotonic() > end:
        sys.exit("the screen has %d colours, mean %s; the picture %d, %s" % (colours, mean, wanted_colours, wanted))
    time.sleep(0.3)
