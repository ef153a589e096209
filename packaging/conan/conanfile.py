# SPDX-License-Identifier: MIT OR Apache-2.0
"""A Conan 2 recipe for Linux and macOS, which packs the repository that it lies in. Checked by

    conan create packaging/conan

which builds bhr by cargo and then test_package, a host in C. tests/run all does that with BHR_INSTALL=--no-build and
CARGO_TARGET_DIR, which spare the build.

For Windows packaging/windows-packages copies this file beside a conandata.yml that says where the prebuilt zip is: then
it packs that, and needs no repository. tests/run all does that, too, on Linux.
"""

import os
import re

from conan import ConanFile
from conan.errors import ConanInvalidConfiguration
from conan.tools.files import copy, get


class Bhr(ConanFile):
    name = "bhr"
    description = "Embeddable black-hole renderer with a C API"
    license = "MIT OR Apache-2.0"
    topics = ("black-hole", "relativity", "renderer", "gpu")
    package_type = "library"
    settings = "os", "arch", "compiler", "build_type"
    options = {"shared": [True, False]}
    default_options = {"shared": True}

    def _zip(self):
        """Where the prebuilt zip is, and its checksum, in the recipe for Windows."""
        return (self.conan_data or {}).get("windows")

    def set_version(self):
        if self._zip():
            self.version = self.conan_data["version"]
            return
        with open(os.path.join(self.recipe_folder, "../../Cargo.toml"), encoding="utf-8") as manifest:
            self.version = re.search('^version = "(.*)"', manifest.read(), re.MULTILINE).group(1)

    def configure(self):
        # The library's face is C.
        self.settings.rm_safe("compiler.libcxx")
        self.settings.rm_safe("compiler.cppstd")

    def validate(self):
        if self._zip():
            if self.settings.os != "Windows" or self.settings.arch != "x86_64" or not self.options.shared:
                raise ConanInvalidConfiguration("the prebuilt zip has a shared library for Windows on x86-64")
            return
        if self.settings.os not in ("Linux", "Macos"):
            raise ConanInvalidConfiguration("the recipe runs ./install, which is for Linux and macOS; "
                                            "packaging/windows-packages makes one for Windows")
        if self.settings.os == "Macos" and not self.options.shared:
            raise ConanInvalidConfiguration("./install makes the static library on Linux only")

    def export_sources(self):
        if self._zip():
            return
        sources = os.path.join(self.recipe_folder, "../..")
        for pattern in ("install", "build.rs", "Cargo.*", "LICENSE-*", "THIRD-PARTY.txt", "README.md", "src/*",
                        "shaders/*", "include/*", "benches/*", "packaging/bhr.pc.in", "packaging/cmake/*"):
            copy(self, pattern, sources, self.export_sources_folder)

    def build(self):
        if self._zip():
            get(self, **self._zip(), strip_root=True)

    def package(self):
        if self._zip():
            for folder in "bin", "include", "lib", "share":
                copy(self, "*", os.path.join(self.build_folder, folder), os.path.join(self.package_folder, folder),
                     excludes="*.exe")
            return
        kind = "" if self.options.shared else "--static --no-shared"
        # cargo builds within ./install.
        self.run(f"./install --prefix='{self.package_folder}' --destdir= {kind} {os.environ.get('BHR_INSTALL', '')}",
                 cwd=self.source_folder)

    def package_id(self):
        del self.info.settings.compiler
        del self.info.settings.build_type

    def package_info(self):
        self.cpp_info.libs = ["bhr"]
        self.cpp_info.set_property("pkg_config_name", "bhr")
        self.cpp_info.set_property("cmake_target_name", "bhr::bhr" if self.options.shared else "bhr::static")
        if not self.options.shared:
            self.cpp_info.system_libs = ["gcc_s", "util", "rt", "pthread", "m", "dl"]
