#!/usr/bin/env bash
# Programs as ranks of an MPI job.
#
#   tests/programs/ranks_test.sh PROGRAM_DIR MPIRUN
#
# Two and four ranks find what one process finds; a rank that dies or stalls
# ends all with a checkpoint, from which any number goes on; bad input is one
# line.
set -euo pipefail

programs=$(cd -- "$1" && pwd)
mpirun=$2
data=$(cd -- "$(dirname -- "$0")/../../data" && pwd)
scratch=$(mktemp -d)
Clean() {
  pkill -KILL -f -- "$scratch" 2>/dev/null || true
  rm -rf -- "$scratch"
}
trap Clean EXIT
cd -- "$scratch"
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
export OMPI_MCA_rmaps_base_oversubscribe=1

Fail() {
  echo "$1; standard error was:"
  cat -- stderr
  exit 1
}

# Ranks NUMBER PROGRAM ARGUMENT...: its exit status in $status.
Ranks() {
  local number=$1 program=$2
  shift 2
  status=0
  timeout 120 "$mpirun" -n "$number" "$programs/$program" "$@" \
    >stdout 2>stderr || status=$?
}

# Whether the parameters in folders $1 and $2 are the same to 1e-9.
Same() {
  paste -d, <(cut -d, -f1,4 "$1/parameters.csv") \
    <(cut -d, -f4 "$2/parameters.csv") | awk -F, '
    NR > 1 {
      size = ($2 < 0 ? -$2 : $2) + 1e-3
      off = $2 - $3
      if (off < 0) off = -off
      if (!(off <= 1e-9 * size)) { print $1, $2, $3; wrong = 1 }
      ++count
    }
    END { exit wrong || count == 0 }' || Fail "$1 and $2 differ"
}

# 1. The same as one process: a law on whole records, and segments, which the
# ranks share.
for case in three_storey/three_storey duffing/multiple; do
  name=${case##*/}
  "$programs/pinode_update" --case="$data/$case.toml" \
    --output_dir="one_$name" >stdout 2>stderr || Fail "$case alone"
  for ranks in 2 4; do
    Ranks "$ranks" pinode_update --case="$data/$case.toml" \
      --output_dir="${name}_$ranks"
    [[ $status -eq 0 ]] || Fail "$case on $ranks ranks: status $status"
    [[ $(grep -c '^Results: ' stdout) -eq 1 ]] || Fail "who has written?"
    Same "one_$name" "${name}_$ranks"
  done
done

# The same equations, from bags and a refit that the ranks share.
cp -- "$data"/quarter_car/*.csv .
sed 's/^polynomial_degree.*/&\nbags = 12/' \
  "$data/quarter_car/quarter_car.toml" >bags.toml
Terms() { grep -E '"(basis|inclusion_probability)"' "$1/discover.json"; }
"$programs/pinode_discover" --case=bags.toml --output_dir=one_bags \
  >stdout 2>stderr || Fail "a discovery alone"
Terms one_bags >terms || Fail "no terms"
for ranks in 2 4; do
  Ranks "$ranks" pinode_discover --case=bags.toml --output_dir="bags_$ranks"
  [[ $status -eq 0 ]] || Fail "a discovery on $ranks ranks: status $status"
  [[ $(grep -c '^Results: ' stdout) -eq 1 ]] || Fail "who has written?"
  Terms "bags_$ranks" | cmp - terms || Fail "other terms on $ranks ranks"
  Same one_bags "bags_$ranks"
done

# 2. A rank that dies: mpirun ends the others; the checkpoint is there, and
# another number of ranks goes on from it.
cp -- "$data"/four_dof_free/*.csv "$data/four_dof_free/scheme1.toml" .
AwaitCheckpoint() {
  for ((i = 0; i < 300; ++i)); do
    ! compgen -G "$1.partial-*/checkpoint.json" >/dev/null || return 0
    sleep 0.1
  done
  Fail "no checkpoint"
}
RankOf() {
  pgrep -f -- "pinode_update .*--output_dir=$scratch/$1" | while read -r pid; do
    if tr '\0' '\n' <"/proc/$pid/environ" | grep -qx "OMPI_COMM_WORLD_RANK=$2"
    then
      echo "$pid"
    fi
  done | head -1
}
"$mpirun" -n 3 "$programs/pinode_update" --case=scheme1.toml \
  --output_dir="$scratch/killed" >stdout 2>stderr &
job=$!
AwaitCheckpoint killed
kill -KILL "$(RankOf killed 1)"
status=0
wait "$job" || status=$?
[[ $status -ne 0 && ! -e killed ]] || Fail "a killed rank went unnoticed"
AwaitCheckpoint killed
sed -i 's/^max_iterations.*/max_iterations = 40/' scheme1.toml
grep -q '^max_iterations' scheme1.toml ||
  sed -i 's/^\[options\]/&\nmax_iterations = 40/' scheme1.toml
Ranks 2 pinode_update --case=scheme1.toml --output_dir="$scratch/killed" \
  --resume
[[ -s killed/result.json ]] || Fail "resumed after a kill: status $status"

# 3. A rank that stalls is waited for no longer than it is told.
sed -i 's/^max_iterations.*/max_iterations = 2000/' scheme1.toml
"$mpirun" -n 2 "$programs/pinode_update" --case=scheme1.toml \
  --output_dir="$scratch/stalled" --rank_timeout=2 >stdout 2>stderr &
job=$!
AwaitCheckpoint stalled
pid=$(RankOf stalled 1)
kill -STOP "$pid"
status=0
wait "$job" || status=$?
kill -KILL "$pid" 2>/dev/null || true
[[ $status -ne 0 && ! -e stalled ]] || Fail "a stalled rank went unnoticed"
[[ $(grep -c 'a rank has not answered for 2 s; .*--resume' stderr) -eq 1 ]] ||
  Fail "expected a line about the rank that does not answer"
AwaitCheckpoint stalled

# 4. What is wrong is said once.
Ranks 2 pinode_update --case=missing.toml --output_dir=missing
[[ $status -eq 2 && $(grep -c 'missing.toml' stderr) -eq 1 ]] ||
  Fail "bad input: status $status"
Ranks 2 pinode_check --case="$data/three_storey/three_storey.toml"
[[ $status -eq 2 ]] && grep -q 'pinode_check runs in one process' stderr ||
  Fail "pinode_check on two ranks: status $status"
