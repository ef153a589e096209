# SPDX-License-Identifier: MIT OR Apache-2.0
"""Packs a star catalogue from CSV into stars.bin, as README.md here describes it.

    python3 pack.py hipparcos_mag9.csv stars.bin

The CSV has the columns hip, ra_deg, dec_deg, v_mag, b_v (J2000 degrees; b_v may be empty).
"""

import csv
import struct
import sys

FAINTEST = 8.0
RECORD = struct.Struct("<Iihh")
UNKNOWN_COLOUR = -32768


def record(row):
    colour = round(float(row["b_v"]) * 1000) if row["b_v"] else UNKNOWN_COLOUR
    return RECORD.pack(
        round(float(row["ra_deg"]) % 360.0 * 10000) % 3600000,
        round(float(row["dec_deg"]) * 10000),
        round(float(row["v_mag"]) * 1000),
        colour,
    )


def main(source, target):
    with open(source, newline="", encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if float(row["v_mag"]) <= FAINTEST]
    rows.sort(key=lambda row: (float(row["v_mag"]), int(row["hip"])))
    with open(target, "wb") as file:
        file.write(b"".join(map(record, rows)))
    print(f"{len(rows)} stars, {len(rows) * RECORD.size} bytes")


if __name__ == "__main__":
    main(*sys.argv[1:])
