"""pip installs the package from a checkout without a network."""

import os
import pathlib
import shutil
import subprocess
import sys

SOURCE = pathlib.Path(os.environ["PINODE_SOURCE_DIR"])


def test_pip_installs_the_checkout(tmp_path):
    checkout = tmp_path / "checkout"
    checkout.mkdir()
    # pip leaves files beside setup.py; the compiled module is that of the build
    # folder (PINODE_BUILD_DIR).
    for name in ("pyproject.toml", "setup.py", "CMakeLists.txt"):
        shutil.copy(SOURCE / name, checkout / name)
    os.symlink(SOURCE / "pinode", checkout / "pinode")
    subprocess.run([sys.executable, "-m", "venv", "--system-site-packages",
                    tmp_path / "v"], check=True)
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
    python = tmp_path / "v" / "bin" / "python"
    subprocess.run([python, "-m", "pip", "install", "--quiet", "--no-build-isolation",
                    "--no-index", checkout], check=True, env=environment)
    script = ("import pinode, sys\n"
              "case = pinode.Case(pinode.Model([[1.0]], [[100.0]]))\n"
              "print(pinode.__file__, case.natural_modes()['frequencies_hz'][0])")
    done = subprocess.run([python, "-c", script], check=True, env=environment,
                          capture_output=True, text=True, cwd=tmp_path)
    where, frequency = done.stdout.split()
    assert where.startswith(str(tmp_path / "v"))
    assert abs(float(frequency) - 10 / (2 * 3.141592653589793)) < 1e-12
    files = set(os.listdir(pathlib.Path(where).parent))
    assert {"py.typed", "_pinode.pyi", "opensees.py", "elements.py"} <= files
    # What an element of one's own includes is there.
    source = ("#include <pinode/dynamics/own_element.h>\n"
              "PINODE_ELEMENTS(library) { (void)library; }\n")
    script = ("import pinode\n"
              f"print(pinode.elements.build({source!r}, 'none.so'))")
    done = subprocess.run([python, "-c", script], env=environment, capture_output=True,
                          text=True, cwd=tmp_path, check=True)
    assert done.stdout.strip() == str(tmp_path / "none.so")
