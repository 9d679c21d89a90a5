#!/usr/bin/env bash
# From a record to equations with the programs alone.
#
#   tests/programs/discover_test.sh PROGRAM_DIR
#
# pinode_update trains the network of data/four_dof_free/scheme3,
# pinode_discover finds the cubic spring in its place, and pinode_simulate reads
# what it leaves behind. Then a refit of data/quarter_car, which needs no network,
# is interrupted and goes on.
set -euo pipefail

programs=$(cd -- "$1" && pwd)
here=$(cd -- "$(dirname -- "$0")" && pwd)
data=$(cd -- "$here/../../data/four_dof_free" && pwd)
scratch=$(mktemp -d)
running=
Clean() {
  [[ -z $running ]] || kill -KILL "$running" 2>/dev/null || true
  rm -rf -- "$scratch"
}
trap Clean EXIT
cp -- "$data"/*.toml "$data"/*.csv "$data"/../quarter_car/*.{toml,csv} "$scratch"
cd -- "$scratch"

tested=pinode_discover
source "$here/testing.sh"

Run 0 pinode_update --case=scheme3.toml --output_dir=D --progress=false

# What is wrong is said before anything is written.
Refused "--model=FOLDER is missing" --case=scheme3.toml --output_dir=E
Refused "--case=FILE is missing" --model=D --output_dir=E
Refused "--output_dir=FOLDER is missing" --model=D --case=scheme3.toml
Refused "nowhere: there is no such folder" --model=nowhere \
  --case=scheme3.toml --output_dir=E
Refused "checkpoint.json" --model=D --case=scheme2.toml --output_dir=E
Refused "give another folder" --model=D --case=scheme3.toml --output_dir=D \
  --overwrite
Refused "which uses no model" --model=D --case=quarter_car.toml --output_dir=E
Refused "--threads is -1, expected a number of threads" --model=D --case=scheme3.toml \
  --output_dir=E --threads=-1
# A network that has to be trained, and a DOF that no displacement shows.
sed 's/"derivatives"/"network"/' quarter_car.toml >untrained.toml
Refused "--model=FOLDER is missing" --case=untrained.toml --output_dir=E
sed 's/column   = "xu"/column   = "xu"\n  fit      = false/' quarter_car.toml \
  >unseen.toml
Refused "record 'drive', DOF 'u': it has no displacement channel" \
  --case=unseen.toml --output_dir=E
cp scheme3.toml wrong.toml
printf "\n[discover]\nsinus = []\n" >>wrong.toml
Refused "wrong.toml:" --model=D --case=wrong.toml --output_dir=E

# The cubic spring and nothing else.
Run 0 pinode_discover --model=D --case=scheme3.toml --output_dir=E
for file in discover.json equations.txt equations.tex model.toml result.json \
  parameters.csv report.html; do
  [[ -s E/$file ]] || Fail "E lacks $file"
done
[[ $(grep -c '"basis"' E/discover.json) -eq 1 ]] ||
  Fail "not one term: $(cat E/discover.json)"
grep -qF '"basis": "x[x1]^3"' E/discover.json || Fail "no cubic spring"
awk -F: '/"coefficient"/ { off = $2 / -2 - 1; if (off < 0) off = -off
    found = 1; if (off > 1e-6) exit 1 }
  END { if (!found) exit 1 }' E/discover.json ||
  Fail "the coefficient is not -2: $(grep coefficient E/discover.json)"
Run 2 pinode_discover --model=D --case=scheme3.toml --output_dir=E

# The model that has it: the unseen start h3, 12 s, is known there.
Run 0 pinode_simulate --case=E/model.toml --output_dir=S
paste -d, h3.csv S/response_h3.csv | awk -F, '
  NR == 1 { columns = NF / 2; next }
  { for (i = 2; i <= columns; ++i) {
      error = $i - $(i + columns)
      if (error < 0) error = -error
      if (error > worst) worst = error } }
  END { if (NR < 200 || worst > 1e-7) { print worst; exit 1 } }' >stdout ||
  Fail "h3 is not simulated"

# Nothing that is worth a term: the files say so.
cp scheme3.toml none.toml
printf '\n[discover]\ntolerance = 0.9\n' >>none.toml
Run 1 pinode_discover --model=D --case=none.toml --output_dir=N
grep -qF 'no term was found' N/discover.json || Fail "no message"
grep -qF '"usable": false' N/discover.json || Fail "usable without a term"

# Interrupted on its way, and continued.
"$programs/pinode_discover" --case=quarter_car.toml --output_dir=Q \
  >stdout 2>stderr &
running=$!
for ((i = 0; i < 1200; ++i)); do
  [[ ! -s $(echo Q.partial-*/checkpoint.json) ]] || break
  kill -0 "$running" 2>/dev/null || Fail "ended before its signal"
  sleep 0.05
done
kill -INT "$running"
status=0
wait "$running" || status=$?
running=
[[ $status -eq 3 ]] || Fail "interrupted: status $status, expected 3"
grep -q -e '--resume' stderr || Fail "does not mention --resume"
grep -qF '"usable": false' Q/discover.json || Fail "interrupted, but usable"
grep -qF 'pinode-discover-checkpoint-1' Q/checkpoint.json || Fail "no checkpoint"
Run 2 pinode_discover --case=quarter_car.toml --output_dir=Q
# Another problem does not take it over, nor does another library.
sed 's/290/291/' quarter_car.toml >other.toml
Run 2 pinode_discover --case=other.toml --output_dir=Q --resume
grep -qF 'belongs to another case' stderr || Fail "taken over by another case"
sed 's/polynomial_degree = 2/expressions = ["x[s]^3"]\npolynomial_degree = 0/' \
  quarter_car.toml >other.toml
Run 2 pinode_discover --case=other.toml --output_dir=Q --resume
grep -qF 'not a candidate of the section' stderr || Fail "taken over by another library"
Run 0 pinode_discover --case=quarter_car.toml --output_dir=Q --resume
grep -qF '"usable": true' Q/discover.json || Fail "not usable after --resume"
[[ $(grep -c '"basis"' Q/discover.json) -eq 9 ]] ||
  Fail "not nine terms: $(cat Q/equations.txt)"
grep -qF '<h2>Equations</h2>' Q/report.html || Fail "no equations in the report"
Run 2 pinode_discover --case=quarter_car.toml --output_dir=Q --resume
grep -qF 'refit there is complete' stderr || Fail "resumed what was finished"
