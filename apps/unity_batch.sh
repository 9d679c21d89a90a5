#!/usr/bin/env bash
# Prints how many sources a build should compile at a time (PINODE_UNITY_BATCH)
# when nobody is going to change one of them.
#
#   apps/unity_batch.sh JOBS [MOST]
#
# JOBS is how many compilers run at once. Sixteen sources take up to 1.5 GB by
# clang and 2.6 GB by GCC (pinode/modal), and four up to 1.2 GB. MOST limits the
# number: eight under the sanitizers, whose larger batches were not measured.
set -euo pipefail

jobs=$1
most=${2:-16}
memory_kib=$(awk '/^MemTotal:/ {print $2}' /proc/meminfo)
batch=4
if ((memory_kib / jobs > 3000000)); then
  batch=16
elif ((memory_kib / jobs > 2000000)); then
  batch=8
fi
echo $((batch < most ? batch : most))
