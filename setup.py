"""Builds Python's package pinode by CMake; what it needs is in apps/packages.txt
and tests/packages.txt.

    pip install --no-build-isolation .

PINODE_BUILD_DIR names a build folder of the project that is there already;
PINODE_NATIVE=OFF builds for any x86-64 in place of this machine.
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = pathlib.Path(__file__).resolve().parent


class CMakeBuild(build_ext):
    def build_extension(self, ext):
        given = os.environ.get("PINODE_BUILD_DIR")
        folder = pathlib.Path(given or self.build_temp).resolve()
        if not given:
            folder.mkdir(parents=True, exist_ok=True)
            generator = ["-G", "Ninja"] if shutil.which("ninja") else []
            native = os.environ.get("PINODE_NATIVE", "ON")
            subprocess.run(
                ["cmake", "-S", ROOT, "-B", folder, *generator,
                 "-DCMAKE_BUILD_TYPE=Release", "-DPINODE_PYTHON=ON",
                 "-DPINODE_BUILD_TESTS=OFF", "-DPINODE_BUILD_APPS=OFF",
                 "-DPINODE_MPI=OFF", "-DPINODE_UNITY_LIBRARY=ON",
                 "-DPINODE_WERROR=OFF", f"-DPINODE_NATIVE={native}",
                 f"-DPython3_EXECUTABLE={sys.executable}"],
                check=True)
        subprocess.run(
            ["cmake", "--build", folder, "--target", "pinode_python",
             "--parallel", str(os.cpu_count() or 1)],
            check=True)
        built, = (folder / "pinode" / "python" / "pinode").glob("_pinode*.so")
        target = pathlib.Path(self.get_ext_fullpath(ext.name))
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(built, target)
        self.copy_headers(folder, target.parent / "include")

    # For elements of one's own (pinode.elements): the public headers.
    def copy_headers(self, folder, include):
        for header in (folder / "public_headers.txt").read_text().split():
            if header.startswith("pinode/mpi/"):
                continue
            copy = include / header
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(ROOT / header, copy)


VERSION = re.search(r"project\(pinode VERSION ([0-9.]+)",
                    (ROOT / "CMakeLists.txt").read_text()).group(1)

setup(version=VERSION, ext_modules=[Extension("pinode._pinode", sources=[])],
      cmdclass={"build_ext": CMakeBuild})
