# SPDX-License-Identifier: MIT OR Apache-2.0
"""Looks into a package for NuGet as NuGet and MSBuild would: the parts that the Open Packaging Conventions ask for, the
manifest, and that what bhr.targets names is in the package.

    nupkg.py PACKAGE VERSION
"""

import posixpath
import re
import sys
import zipfile
from xml.etree import ElementTree

CORE = "{http://schemas.openxmlformats.org/package/2006/%s}"

package = zipfile.ZipFile(sys.argv[1])
assert package.testzip() is None
names = package.namelist()
assert len(set(names)) == len(names) > 20 and not any("\\" in name or name.endswith("/") for name in names), names

types = ElementTree.fromstring(package.read("[Content_Types].xml"))
known = {one.get("Extension") for one in types.iter(CORE % "content-types" + "Default")}
for name in names:
    assert name == "[Content_Types].xml" or name.rsplit(".", 1)[-1] in known, f"{name} has no content type"

relations = ElementTree.fromstring(package.read("_rels/.rels"))
targets = {one.get("Type").rsplit("/", 1)[1]: one.get("Target") for one in relations}
assert targets["manifest"] == "/bhr.nuspec", targets
properties = ElementTree.fromstring(package.read(targets["core-properties"].lstrip("/")))
assert properties.findtext(CORE % "metadata/core-properties" + "version") == sys.argv[2]

manifest = ElementTree.fromstring(package.read("bhr.nuspec"))
of = {one.tag.split("}")[1]: one for one in manifest[0]}
assert (of["id"].text, of["version"].text) == ("bhr", sys.argv[2])
assert (of["license"].get("type"), of["license"].text) == ("expression", "MIT OR Apache-2.0")
assert of["readme"].text in names and of["authors"].text and of["description"].text.strip()

# NuGet imports this file for its name, which is the package's id.
targets = package.read("build/native/bhr.targets").decode()
ElementTree.fromstring(targets)
found = re.findall(r"\$\((?:BhrFolder|MSBuildThisFileDirectory)\)([\w.\\-]+)", targets)
assert len(found) == 3, found
for path in found:
    path = posixpath.normpath("build/native/" + path.replace("\\", "/"))
    assert any(name == path or name.startswith(path + "/") for name in names), f"{path} is not in the package"
print(f"{len(names)} files")
