"""Starts the programs of the wheel: each command `pinode_...` that pip installs
calls main(), which becomes the program of its name in the package's folder `bin`.

It stands beside the package and does not import it, so that a program starts
without NumPy.
"""

import os
import sys
from pathlib import Path


def main() -> None:
    """Replaces this process by the program that it was called as."""
    program = Path(__file__).parent / "pinode" / "bin" / Path(sys.argv[0]).name
    try:
        os.execv(program, sys.argv)
    except OSError as error:
        sys.exit(f"{program}: {error.strerror}. Install pinode again: "
                 "pip install --force-reinstall pinode")
