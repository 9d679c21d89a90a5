"""Elements of your own: C++ functors, compiled into a library that a case names.

    path = pinode.elements.build('''
    struct Sticky {
      // q: deformation and its rate; z: internal states; p: parameters; result:
      // the force, then the rates of the internal states.
      template <typename T>
      void operator()(const T* q, const T* z, const T* p, T* result) const {
        using std::tanh;
        result[0] = p[0] * q[0] + p[1] * tanh(q[1] / p[2]);
      }
    };
    PINODE_ELEMENTS(library) {
      // Numbers of internal states and parameters. Then for each parameter:
      // its name, its dimension as powers of force, length and time, its limits,
      // and its default.
      pinode::AddElement<Sticky, 0, 3>(
          "sticky", {{"k", 1, -1, 0}, {"f", 1, 0, 0}, {"v0", 0, 1, -1, 1e-9}},
          library);
    }
    ''', "sticky.so")
    pinode.Element("damper", "sticky", ("ground", "u1"),
                   {"k": 100.0, "f": pinode.Unknown(1.0), "v0": 0.01}, file=path)
"""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from . import _pinode
from ._part import as_path, as_sequence
from ._pinode import Error

_HEADER = "pinode/dynamics/own_element.h"
_PREFIXES = (Path(sys.prefix), Path("/usr/local"), Path("/usr"))


def include_paths() -> list[str]:
    """Returns the folders with the headers of pinode and Eigen.

    Only usual places are searched. The compiler itself finds the headers of Ceres.
    """
    own = Path(__file__).parent / "include"
    places = [own, *(prefix / "include" for prefix in _PREFIXES)]
    pinode = [place for place in places if (place / _HEADER).exists()]
    eigen = [place / "eigen3" for place in places if (place / "eigen3/Eigen").exists()]
    return [str(place) for place in (*pinode[:1], *eigen[:1])]


def build(
    source: str | os.PathLike[str],
    library: str | os.PathLike[str],
    *,
    include: Sequence[str | os.PathLike[str]] = (),
    compiler: str = "c++",
) -> str:
    """Compiles a source into a shared library. Returns its absolute path.

    Use the path as `file` of an Element.

    source: C++ text, or the path of a file. pinode/dynamics/own_element.h is included
        before a text.
    library: path of the shared library to be written.
    include: further folders with headers.
    compiler: command of the C++ compiler.

    Raises pinode.Error with the compiler's message if the compilation fails.
    """
    if not isinstance(source, (str, os.PathLike)):
        raise Error(f"source is a value of type {type(source).__name__}, expected a text or a path")
    is_file = isinstance(source, os.PathLike) or "{" not in source
    if is_file:
        source = as_path("source", source)
    compiler = as_path("compiler", compiler)
    target = Path(as_path("library", library)).absolute()
    paths = [*(as_path("include", path) for path in as_sequence("include", include)), *include_paths()]
    if shutil.which(compiler) is None:
        raise Error(f"the compiler '{compiler}' is not installed, expected one of C++")
    with tempfile.TemporaryDirectory() as folder:
        if is_file:
            file = Path(source)
            if not os.path.isfile(file):
                raise Error(f"{file}: is no file, expected a source of C++")
        else:
            file = Path(folder, "elements.cc")
            text = f'#include "{_HEADER}"\n#line 1 "source"\n{source}'
            file.write_text(text, encoding="utf-8", errors="replace")
        made = Path(folder, "elements.so")
        command = [compiler, "-std=c++17", "-O2", "-shared", "-fPIC",
                   *shlex.split(_pinode.element_compiler_flags()),
                   *(f"-I{path}" for path in paths), "-o", str(made), str(file)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            lines = done.stderr.splitlines()
            wrong = [line for line in lines if "error:" in line] or lines or ["no reason given"]
            raise Error(f"{compiler} cannot compile the elements: {wrong[0].strip()}")
        try:
            partial = target.with_name(f"{target.name}.{os.getpid()}.partial")
            shutil.copyfile(made, partial)
            os.replace(partial, target)
        except OSError as failure:
            raise Error(f"{target}: cannot be written: {failure}") from None
    return str(target)


__all__ = ["build", "include_paths"]
