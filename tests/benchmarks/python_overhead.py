#!/usr/bin/env python3
"""CPU and memory of a case in Python and by the program, in turns.

    tests/benchmarks/python_overhead.py [--build=FOLDER] [--rounds=5] [CASE]

Both read the case, fit it on one thread and write the result folder with its
report. CPU is user and system time of the process, gnuplot's included; the time
of `import pinode` is measured apart and taken off, as is the interpreter's. So
is memory: what the case adds to `import pinode`, beside what it adds to the
program that says its version and ends. Medians over the rounds.
"""

import argparse
import os
import pathlib
import statistics
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]


def run(command, environment):
    """CPU seconds and peak memory (MB) of a process."""
    process = os.fork()
    if process == 0:
        null = os.open(os.devnull, os.O_WRONLY)
        os.dup2(null, 1)
        os.dup2(null, 2)
        os.execve(command[0], command, environment)
    _, status, usage = os.wait4(process, 0)
    if status != 0:
        raise SystemExit(f"failed: {' '.join(command)}")
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", default=ROOT / "build-release")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("case", nargs="?",
                        default=ROOT / "data" / "three_storey" / "three_storey.toml")
    args = parser.parse_args()
    build = pathlib.Path(args.build).resolve()
    environment = {**os.environ, "PYTHONPATH": str(build / "pinode" / "python")}
    interpreter = "/usr/bin/python3" if os.path.exists("/usr/bin/python3") else sys.executable
    program, python, imports, starts = [], [], [], []
    with tempfile.TemporaryDirectory() as folder:
        for i in range(args.rounds):
            program.append(run(
                [str(build / "apps" / "pinode_update"), f"--case={args.case}", "--threads=1",
                 "--noprogress", f"--output_dir={folder}/a{i}"], environment))
            starts.append(run([str(build / "apps" / "pinode_update"), "--version"], environment))
            script = (f"import pinode; pinode.read_case({str(args.case)!r}).identify("
                      f"threads=1, progress=False, output={folder + f'/b{i}'!r})")
            python.append(run([interpreter, "-c", script], environment))
            imports.append(run([interpreter, "-c", "import pinode"], environment))

    def median(runs, which):
        return statistics.median(r[which] for r in runs)

    added = median(python, 1) - median(imports, 1)
    own = median(program, 1) - median(starts, 1)
    cpu = median(python, 0) - median(imports, 0)
    print(f"program      {median(program, 0):7.3f} s  {median(program, 1):6.1f} MB")
    print(f"Python       {cpu:7.3f} s  {median(python, 1):6.1f} MB, import apart")
    print(f"import       {median(imports, 0):7.3f} s  {median(imports, 1):6.1f} MB")
    print(f"--version    {median(starts, 0):7.3f} s  {median(starts, 1):6.1f} MB")
    print(f"the case adds {own:.1f} MB to the program, {added:.1f} to Python")
    print(f"overhead, import apart: {100 * (cpu / median(program, 0) - 1):+.1f} % of CPU, "
          f"{100 * (added / own - 1):+.1f} % of memory; interpreter and all "
          f"{100 * (median(python, 1) / median(program, 1) - 1):+.1f} % of memory")


if __name__ == "__main__":
    main()
