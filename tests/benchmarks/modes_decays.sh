#!/usr/bin/env bash
# Modes that pinode_modes finds in free decays of random structures, at noise
# from 1e-12 to 0.1 of each channel's standard deviation: invented, listed
# twice, missed, and how often 95 % intervals hold the truth.
#
#   tests/benchmarks/modes_decays.sh [DECAYS [SEED]]
#
# NumPy and SciPy, of PYTHON, default python3. With KEEP=FOLDER the records and
# results stay there.
set -euo pipefail

source "$(dirname -- "${BASH_SOURCE[0]}")/ambient/setup.sh" \
  "numpy, scipy" pinode_modes
"${PYTHON:-python3}" tests/benchmarks/modes_decays.py \
  --program "$build/apps/pinode_modes" --work "$work" \
  --decays "${1:-100}" --seed "${2:-1}"
