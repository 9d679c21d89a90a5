"""The generator of data/three_storey_ambient as a module, CASE, and the names of
the case's groups."""

import importlib.util
import os
import sys

sys.dont_write_bytecode = True
PATH = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..",
                    "..", "data", "three_storey_ambient", "generate.py")
SPEC = importlib.util.spec_from_file_location("generate", PATH)
CASE = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(CASE)
NAMES = ["k1", "k2", "k3", "c_mass", "c_stiffness"]
