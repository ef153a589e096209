# SPDX-License-Identifier: MIT OR Apache-2.0
"""Reads FITS files with astropy, as their users do: nothing in them has to be fixed, and the hole is in the middle.
Needs astropy."""
import sys

from astropy.io import fits
from astropy.time import Time
from astropy.units import Unit
from astropy.wcs import WCS

for path in sys.argv[1:]:
    with fits.open(path) as file:
        file.verify("exception")
        image = file[0]
        header = image.header
        assert Unit(header["BUNIT"], format="fits", parse_strict="raise") == Unit("Jy/pixel")
        assert Time(header["DATE-OBS"]).mjd == header["MJD-OBS"]
        assert image.data.dtype.itemsize == 8 and abs(image.data.sum() / header["FLUX"] - 1) < 1e-12
        wcs = WCS(header)
        middle = wcs.pixel_to_world((header["NAXIS1"] - 1) / 2, (header["NAXIS2"] - 1) / 2)
        assert abs(middle.ra.deg - header["CRVAL1"]) < 1e-9 and abs(middle.dec.deg - header["CRVAL2"]) < 1e-9
        # East is left, north is up.
        assert wcs.pixel_to_world(0, 0).ra > middle.ra > wcs.pixel_to_world(header["NAXIS1"] - 1, 0).ra
        assert wcs.pixel_to_world(0, header["NAXIS2"] - 1).dec > middle.dec
        print(path.split("/")[-1], header["OBJECT"], header["FLUX"], wcs.wcs.radesys)
