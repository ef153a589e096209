# SPDX-License-Identifier: MIT OR Apache-2.0
"""Looks into a wheel that this machine's Python cannot import: its tag, its files, their checksums in RECORD, and the
library, byte for byte.

    foreign_wheel.py WHEEL LIBRARY
    foreign_wheel.py --heads FOLDER     writes stand-ins for libraries, named by their platforms
"""

import base64
import csv
import email
import hashlib
import pathlib
import struct
import sys
import zipfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent


def heads(folder):
    elf = b"\x7fELF\x02\x01\x01".ljust(16, b"\0") + struct.pack("<HH", 3, 183)
    (folder / "linux_aarch64").write_bytes(elf.ljust(64, b"\0"))
    pe = b"MZ".ljust(60, b"\0") + struct.pack("<I", 64) + b"PE\0\0" + struct.pack("<H", 0x8664)
    (folder / "win_amd64").write_bytes(pe.ljust(256, b"\0"))


def look(wheel, library):
    name, version, *tag = wheel.stem.split("-")
    platform = tag[2]
    info = f"{name}-{version}.dist-info"
    inside = {one.filename: zipfile.ZipFile(wheel).read(one) for one in zipfile.ZipFile(wheel).infolist()}
    assert (name, tag[:2]) == ("bhr", ["py3", "none"]), wheel.name
    head = email.message_from_bytes(inside[f"{info}/WHEEL"])
    assert head.get_all("Tag") == ["-".join(tag)] and head["Root-Is-Purelib"] == "false", inside[f"{info}/WHEEL"]

    file = "bhr.dll" if platform.startswith("win") else "libbhr.so"
    sources = {f"bhr/{one.name}" for one in (ROOT / "python/src/bhr").iterdir() if one.is_file()}
    package = {one for one in inside if one.startswith("bhr/")}
    assert package == sources | {"bhr/_ffi.py", f"bhr/{file}"}, sorted(package)
    assert inside[f"bhr/{file}"] == library.read_bytes(), "another library"
    for licence in "LICENSE-MIT", "LICENSE-APACHE", "THIRD-PARTY.txt":
        assert inside[f"{info}/licenses/{licence}"] == (ROOT / licence).read_bytes(), licence

    record = {row[0]: row[1:] for row in csv.reader(inside[f"{info}/RECORD"].decode().splitlines())}
    assert record.keys() == inside.keys() and record.pop(f"{info}/RECORD") == ["", ""]
    for path, (digest, size) in record.items():
        right = base64.urlsafe_b64encode(hashlib.sha256(inside[path]).digest()).decode().rstrip("=")
        assert (digest, int(size)) == (f"sha256={right}", len(inside[path])), path
    assert email.message_from_bytes(inside[f"{info}/METADATA"])["Version"] == version
    print(f"{wheel.name}: {len(inside)} files, {file} has {library.stat().st_size} bytes")


if sys.argv[1] == "--heads":
    heads(pathlib.Path(sys.argv[2]))
else:
    look(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]))
