# SPDX-License-Identifier: MIT OR Apache-2.0
"""Builds tests/install/host.c with the package, by the compiler and pkg-config, and runs it."""

import os

from conan import ConanFile


class Test(ConanFile):
    settings = "os", "arch", "compiler", "build_type"
    generators = "PkgConfigDeps", "VirtualRunEnv"

    def layout(self):
        self.folders.build = "build"
        self.folders.generators = "build"

    def requirements(self):
        self.requires(self.tested_reference_str)

    def build(self):
        host = os.path.join(self.recipe_folder, "../../../tests/install/host.c")
        self.run(f"cc -std=c99 -Wall -Wextra -Werror '{host}' -o host "
                 "$(PKG_CONFIG_PATH=. pkg-config --cflags --libs bhr)", cwd=self.generators_folder)

    def test(self):
        self.run("./host", cwd=self.generators_folder, env="conanrun")
