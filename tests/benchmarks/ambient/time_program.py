#!/usr/bin/env python3
"""time_program.py NAME PROGRAM ARGUMENTS: CPU seconds, peak memory, and the
first line that the program prints."""

import resource
import subprocess
import sys

done = subprocess.run(sys.argv[2:], capture_output=True, text=True, check=False)
usage = resource.getrusage(resource.RUSAGE_CHILDREN)
print(f"{sys.argv[1]}: {usage.ru_utime + usage.ru_stime:.1f} s CPU, "
      f"{usage.ru_maxrss / 1024:.0f} MB, status {done.returncode}: "
      f"{(done.stdout.splitlines() or [''])[0][:100]}")
