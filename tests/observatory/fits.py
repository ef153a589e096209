# SPDX-License-Identifier: MIT OR Apache-2.0
"""Reads FITS images by the standard alone (FITS 4.0, 2018, sections 3 and 4), and compares them with what observatory
printed about them: fits.py FOLDER PRINTED PIXELS FOV BEAM, the last two in microarcseconds. Knows no library."""
import re
import struct
import sys
from datetime import date
from pathlib import Path


def read(path):
    """The cards of a file, in a dictionary with texts and numbers, and its rows of pixels, the bottom one first."""
    data = path.read_bytes()
    assert len(data) % 2880 == 0, (path, len(data))
    cards, order, at = {}, [], 0
    while True:
        card = data[at : at + 80].decode("ascii")
        at += 80
        assert card.isprintable(), card
        name = card[:8].rstrip()
        if name == "END":
            assert card == "END".ljust(80), card
            break
        if name in ("HISTORY", "COMMENT"):
            cards.setdefault(name, []).append(card[8:].strip())
            continue
        assert re.fullmatch(r"[A-Z0-9_-]{1,8}", name) and card[8:10] == "= ", card
        assert name not in cards, name
        order.append(name)
        text = re.match(r"'((?:[^']|'')*)'", card[10:])
        # Numbers and logical values in fixed format end in column 30; texts begin in column 11.
        value = text[1].replace("''", "'").rstrip() if text else card[10:30].strip()
        assert text or (card[29] != " " and card[30:33] in ("   ", " / ")), card
        cards[name] = value if text or value in ("T", "F") else float(value)
    assert order[:5] == ["SIMPLE", "BITPIX", "NAXIS", "NAXIS1", "NAXIS2"] and cards["SIMPLE"] == "T", order
    header = -(-at // 2880) * 2880
    assert set(data[at:header]) <= {32}, "blanks fill the header's last block"
    assert cards["BITPIX"] == -64 and cards["NAXIS"] == 2
    width, height = int(cards["NAXIS1"]), int(cards["NAXIS2"])
    end = header + 8 * width * height
    assert len(data) == -(-end // 2880) * 2880 and not any(data[end:]), "zeros fill the last block"
    pixels = struct.unpack(f">{width * height}d", data[header:end])
    return cards, [pixels[row * width : (row + 1) * width] for row in range(height)]


def check(line, folder, pixels, fov, beam):
    ghz, flux, kept, peak, name = re.match(
        r" *(\S+) GHz  flux (\S+) Jy, (\S+) Jy in the file; peak (\S+) K; optical depth \S+; .*/([^/]*)$", line
    ).groups()
    cards, rows = read(folder / name)
    assert len(rows) == pixels == len(rows[0])
    values = [value for row in rows for value in row]
    assert all(0.0 <= value < 10.0 for value in values), "no NaN"
    total = sum(values)
    assert abs(total / float(kept) - 1) < 1e-5 and abs(total / cards["FLUX"] - 1) < 1e-12, (total, kept)
    assert total <= float(flux) * 1.00001 and abs(cards["FLUXSRC"] / float(flux) - 1) < 1e-5
    # Units are case-sensitive: Jy and pixel, of FITS 4.0's tables 3 and 4.
    assert cards["BUNIT"] == "Jy/pixel" and cards["FREQ"] == float(ghz) * 1e9
    # The nominal day; MJD 51544 is 2000-01-01.
    day = (date.fromisoformat(cards["DATE-OBS"]) - date(2000, 1, 1)).days + 51544
    assert cards["MJD"] == cards["MJD-OBS"] == day and cards["DATE-OBS"].startswith("2017-04-"), day
    # A degree has 3.6e9 microarcseconds.
    assert abs(cards["CDELT2"] * 3.6e9 * pixels / fov - 1) < 1e-12 and cards["CDELT1"] == -cards["CDELT2"]
    assert abs(cards["BMAJ"] * 3.6e9 - beam) < 1e-9 and cards["BMIN"] == cards["BMAJ"]
    assert (cards["CTYPE1"], cards["CTYPE2"]) == ("RA---SIN", "DEC--SIN")
    assert cards["CRPIX1"] == cards["CRPIX2"] == (pixels + 1) / 2
    # Rayleigh and Jeans: c^2 I / (2 k nu^2).
    intensity = max(values) * 1e-26 / (cards["CDELT2"] * 3.141592653589793 / 180) ** 2
    kelvin = intensity * (299792458.0 / cards["FREQ"]) ** 2 / (2 * 1.380649e-23)
    assert abs(kelvin / float(peak) - 1) < 0.01 and abs(kelvin / cards["TBPEAK"] - 1) < 1e-9, (kelvin, peak)
    assert any("power-law" in text for text in cards["HISTORY"]), cards["HISTORY"]
    # Matter that turns about a spin to the north approaches in the east, which is left, and shines more there; the spin
    # of the model of M87* points to the east and away from us, so that matter approaches in the south.
    if name.startswith("sgra"):
        left = sum(sum(row[: pixels // 2]) for row in rows)
        assert left > 1.05 * total / 2, (left, total)
    else:
        assert sum(sum(row) for row in rows[: pixels // 2]) > 1.05 * total / 2, total
    print(f"{name}: {total:.6f} Jy")


folder, printed, pixels, fov, beam = sys.argv[1:]
lines = [line for line in Path(printed).read_text().splitlines() if " GHz  flux " in line]
assert lines
for line in lines:
    check(line, Path(folder), int(pixels), float(fov), float(beam))
