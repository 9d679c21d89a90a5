#!/usr/bin/env bash
# Prints how many sources a build should compile at a time (PINODE_UNITY_BATCH)
# when nobody is going to change one of them.
#
#   apps/unity_batch.sh JOBS
#
# JOBS is how many compilers run at once. Sixteen sources take up to 2.6 GB, in
# pinode/modal, and four up to 1.2 GB.
set -euo pipefail

jobs=$1
memory_kib=$(awk '/^MemTotal:/ {print $2}' /proc/meminfo)
if ((memory_kib / jobs > 4000000)); then
  echo 16
else
  echo 4
fi
