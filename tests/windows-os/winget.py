# SPDX-License-Identifier: MIT OR Apache-2.0
"""Checks the manifests for winget: the files are there, each has the fields that winget's schemas require, the checksum
is the zip's, and the zip has the program that they name. The schemas themselves are not used.

    winget.py FOLDER ZIP
"""

import hashlib
import pathlib
import re
import sys
import zipfile

REQUIRED = {
    "bhr.bhr.yaml": "DefaultLocale",
    "bhr.bhr.installer.yaml": "InstallerType NestedInstallerType RelativeFilePath Architecture InstallerUrl "
                              "InstallerSha256",
    "bhr.bhr.locale.en-US.yaml": "PackageLocale Publisher PackageName License ShortDescription",
}
KINDS = {"bhr.bhr.yaml": "version", "bhr.bhr.installer.yaml": "installer", "bhr.bhr.locale.en-US.yaml": "defaultLocale"}

folder, archive = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
assert {path.name for path in folder.iterdir()} == set(REQUIRED), list(folder.iterdir())
said = {}
for name, fields in REQUIRED.items():
    text = (folder / name).read_text(encoding="utf-8")
    assert "@" not in text, f"{name} has a name that nothing was filled in for"
    said[name] = dict(re.findall(r"^(?:- |  )?(\w+): (.+)$", text, re.MULTILINE))
    for field in ["PackageIdentifier", "PackageVersion", *fields.split()]:
        assert said[name].get(field), f"{name} does not say its {field}"
    assert (said[name]["ManifestType"], said[name]["ManifestVersion"]) == (KINDS[name], "1.6.0"), said[name]
assert len({(one["PackageIdentifier"], one["PackageVersion"]) for one in said.values()}) == 1, said
installer = said["bhr.bhr.installer.yaml"]
assert installer["InstallerSha256"] == hashlib.sha256(archive.read_bytes()).hexdigest().upper()
assert re.fullmatch(r"https?://\S+", installer["InstallerUrl"]), installer["InstallerUrl"]
program = installer["RelativeFilePath"].replace("\\", "/")
assert zipfile.ZipFile(archive).read(program)[:2] == b"MZ", program
print(program)
