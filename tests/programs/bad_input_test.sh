#!/usr/bin/env bash
# What the programs do with input that is wrong.
#
#   tests/programs/bad_input_test.sh PROGRAM_DIR
#
# Each trial spoils one thing in a copy of data/three_storey. Expected: exit
# status 2, exactly one line on standard error that names the file, line or key,
# nothing on standard output, and no file that was not there before.
set -euo pipefail

programs=$(cd -- "$1" && pwd)
data=$(cd -- "$(dirname -- "$0")/../../data/three_storey" && pwd)
scratch=$(mktemp -d)
trap 'chmod -R u+w -- "$scratch"; rm -rf -- "$scratch"' EXIT

input=$scratch/area/input
case=$input/three_storey.toml
output=$scratch/area/results/D
trials=0
failures=0

Fail() {
  echo "FAILED $1: $2; it left with $status and wrote:"
  cat -- "$scratch/stdout" "$scratch/stderr"
  failures=$((failures + 1))
}

# Everything that a program could reach: names, of files also size and time.
Listing() {
  (cd -- "$scratch/area" &&
    find . -type d -print -o -printf '%p %s %T@\n' | sort)
}

# A fresh copy in which nothing is wrong.
Fresh() {
  rm -rf -- "$scratch/area"
  mkdir -p -- "$input" "$scratch/area/results"
  cp -- "$data"/*.toml "$data"/*.csv "$input"
}

# The same frame by its matrices instead of its storeys.
FreshMatrices() {
  Fresh
  printf '2000,0,0\n0,2000,0\n0,0,2000\n' >"$input/M.csv"
  printf '%s\n' 6330500,-3898500,0 -3898500,6989500,-3091000 \
    0,-3091000,3091000 >"$input/K.csv"
  sed -i -e '/shear_building/d' -e 's/^masses .*/mass = "M.csv"/' \
    -e 's/^stiffnesses .*/stiffness = "K.csv"/' \
    -e 's/^storey  = 1/between = ["ground", "u1"]/' \
    -e 's/^storey  = 2/between = ["u1", "u2"]/' \
    -e 's/^storey  = 3/between = ["u2", "u3"]/' "$case"
}

# Refused TRIAL FRAGMENT PROGRAM ARGUMENT...; FRAGMENT is an extended regular
# expression that the line must match.
Refused() {
  local trial=$1 fragment=$2 program=$3
  shift 3
  trials=$((trials + 1))
  Listing >"$scratch/before"
  status=0
  "$programs/$program" "$@" >"$scratch/stdout" 2>"$scratch/stderr" || status=$?
  Listing >"$scratch/after"
  if [[ $status -ne 2 ]]; then
    Fail "$trial ($program)" "expected status 2"
  elif [[ $(wc -l <"$scratch/stderr") -ne 1 ]]; then
    Fail "$trial ($program)" "expected one line on standard error"
  elif ! grep -qE -e "$fragment" "$scratch/stderr"; then
    Fail "$trial ($program)" "expected a line that matches '$fragment'"
  elif [[ -s $scratch/stdout ]]; then
    Fail "$trial ($program)" "expected nothing on standard output"
  elif ! cmp -s "$scratch/before" "$scratch/after"; then
    Fail "$trial ($program)" "expected no file to change"
    diff "$scratch/before" "$scratch/after" || true
  elif [[ -n ${VERBOSE:-} ]]; then
    printf '%-28s %s\n' "$trial" "$(sed "s|$scratch/area/||g" \
      "$scratch/stderr")"
  fi
}

# A case that every program refuses, and all with the same words.
BadCase() {
  Refused "$1" "$2" pinode_check --case="$case"
  cp -- "$scratch/stderr" "$scratch/first"
  Refused "$1" "$2" pinode_update --case="$case" --output_dir="$output"
  cmp -s "$scratch/first" "$scratch/stderr" ||
    Fail "$1" "expected pinode_check and pinode_update to agree"
}

# As BadCase, for what a simulation needs too.
BadModel() {
  BadCase "$1" "$2"
  Refused "$1" "$2" pinode_simulate --case="$case" --output_dir="$output"
  cmp -s "$scratch/first" "$scratch/stderr" ||
    Fail "$1" "expected pinode_check and pinode_simulate to agree"
}

# Line number of the first line of the case that matches.
LineOf() { grep -nE -m1 -e "$1" "$case" | cut -d: -f1; }

# What is spoilt below is good before.
for fresh in Fresh FreshMatrices; do
  $fresh
  status=0
  "$programs/pinode_check" --case="$case" >"$scratch/stdout" \
    2>"$scratch/stderr" || status=$?
  [[ $status -eq 0 ]] || Fail "$fresh" "expected the unspoilt case to pass"
done

# Files.
Fresh
rm -- "$case"
BadModel "missing case" 'three_storey\.toml: '

Fresh
rm -- "$input/train.csv"
BadCase "missing record" "toml:$(LineOf '^file  = "train'): .*train\.csv"

Fresh
rm -- "$input/C_mass.csv"
BadModel "missing matrix" 'C_mass\.csv'

Fresh
printf 'title = "Stra\xdfe"\n' | cat - "$data/three_storey.toml" >"$case"
BadModel "case not UTF-8" 'three_storey\.toml:1: .*UTF-8'

Fresh
sed -i '3s/.*/0.01,0,0,0,\xb5,0,0,0,0/' "$input/train.csv"
BadCase "record with a letter of Latin-1" 'train\.csv:3: .* is not a number'

Fresh
echo 'title = "no end' >>"$case"
BadModel "not TOML" "toml:$(wc -l <"$case"): "

# Names.
Fresh
sed -i 's/^damping =/dampings =/' "$case"
BadModel "unknown key" \
  "toml:$(LineOf '^dampings'): .*'dampings'.*did you mean 'damping'"

Fresh
sed -i 's/^between = \["ground", "u1"\]/between = ["ground", "u9"]/' "$case"
BadModel "unknown DOF of an element" "toml:$(LineOf 'u9'): .*'u9'"

Fresh
sed -i '0,/dof      = "u2"/s//dof      = "roof"/' "$case"
BadModel "unknown DOF of a channel" "toml:$(LineOf 'roof'): .*'roof'"

Fresh
sed -i '0,/column   = "a2"/s//column   = "a7"/' "$case"
BadCase "unknown column" "toml:$(LineOf 'a7').*'a7'|train\.csv:1: .*'a7'"

Fresh
sed -i '0,/column    = "ag"/s//column    = "agx"/' "$case"
BadModel "unknown ground column" \
  "toml:$(LineOf 'agx').*'agx'|train\.csv:1: .*'agx'"

Fresh
sed -i '0,/quantity = .*/s//quantity = "acceleration"/' "$case"
BadModel "unknown quantity" "toml:$(LineOf '"acceleration"'): .*quantity"

# Matrices.
FreshMatrices
printf '2000,0\n0,2000\n' >"$input/M.csv"
BadModel "wrong matrix size" 'M\.csv.*2 x 2.*3 x 3'

FreshMatrices
printf '2000,0,0\n0,2000\n0,0,2000\n' >"$input/M.csv"
BadModel "ragged matrix" 'M\.csv:2: '

Fresh
printf '732.2,0\n0,732.2\n' >"$input/C_mass.csv"
BadModel "wrong group matrix size" 'C_mass\.csv.*2 x 2.*3 x 3'

FreshMatrices
printf '2000,50,0\n0,2000,0\n0,0,2000\n' >"$input/M.csv"
BadModel "unsymmetric M" 'mass.*symmetric'

FreshMatrices
printf '2000,0,0\n0,-2000,0\n0,0,2000\n' >"$input/M.csv"
BadModel "indefinite M" 'mass.*positive definite'

Fresh
sed -i 's/^masses .*/masses      = [2000, 0, 2000]/' "$case"
BadModel "storey without mass" "toml:$(LineOf '^masses'): .*mass"

FreshMatrices
sed -i '2s/6989500/nan/' "$input/K.csv"
BadModel "NaN in a matrix" 'K\.csv:2: .*nan'

FreshMatrices
sed -i '2s/6989500/stiff/' "$input/K.csv"
BadModel "text in a matrix" "K\.csv:2: .*'stiff'"

# Records.
Fresh
: >"$input/train.csv"
BadModel "empty record" 'train\.csv.*empty'

Fresh
sed -i '2,$d' "$input/train.csv"
BadModel "record of a header line" 'train\.csv'

Fresh
sed -i '3,$d' "$input/train.csv"
BadModel "one sample" 'train\.csv.*(one|1|two|2) '

Fresh
sed -i '12s/^[^,]*/0.05/' "$input/train.csv"
BadModel "decreasing time" 'train\.csv:12: .*time'

Fresh
sed -i '12s/^[^,]*/soon/' "$input/train.csv"
BadModel "text for a time" "train\.csv:12: .*'soon'"

Fresh
sed -i -E '9s/^(([^,]*,){4})[^,]*/\1broken/' "$input/train.csv"
BadCase "text in a channel" "train\.csv:9: .*'broken'"

Fresh
sed -i -E '2,$s/^(([^,]*,){4})[^,]*/\1off/' "$input/train.csv"
BadCase "channel of text" "train\.csv:2: .*'off'"

Fresh
sed -i '2,$s/^\([^,]*\),[^,]*/\1,nan/' "$input/train.csv"
BadModel "no excitation" "'ag'"

# Steps and units.
Fresh
sed -i -e '0,/^interpolation = "linear"/s//&\nsubsteps = 1/' \
  -e 's/^stiffnesses .*/stiffnesses = [2432e6, 3898e6, 3091e6]/' "$case"
BadModel "sampling too coarse" \
  "toml:$(LineOf '^substeps'): .*substeps = 1, expected at least"

Fresh
sed -i '0,/unit     = "m.s^2"/s//unit     = "mm"/' "$case"
BadModel "unit mismatch" \
  "toml:$(LineOf '"mm"'): record 'train', channel 'a1': unit 'mm'.*accel"

Fresh
sed -i 's/^force  = "N"/force  = "newton"/' "$case"
BadModel "unknown unit" "toml:$(LineOf newton): .*'newton'"

# Unknowns.
Fresh
sed -i -e 's/^adds_to = .*/&\nfree = false/' \
  -e 's/{initial = 0.0}/{initial = 0.0, free = false}/' "$case"
BadCase "no free parameter" 'three_storey\.toml: no parameter is free'

Fresh
sed -i '0,/^lower   = -0.9/s//&\nupper   = -0.95/' "$case"
BadModel "bounds crossed" "toml:[0-9]+: .*'?k1'?.*lower"

Fresh
sed -i '0,/^lower   = -0.9/s//lower   = 0.1/' "$case"
BadModel "start below its bound" "toml:[0-9]+: .*k1"

Fresh
sed -i '0,/^name    = "k2"/s//name    = "k1"/' "$case"
BadModel "a name used twice" 'k1'

# The output folder.
for program in pinode_update pinode_simulate; do
  Fresh
  Refused "no output folder" 'output_dir' $program --case="$case"
  touch -- "$scratch/area/results/file"
  Refused "output below a file" 'results/file' $program --case="$case" \
    --output_dir="$scratch/area/results/file/D"
  Refused "output is a file" 'results/file' $program --case="$case" \
    --output_dir="$scratch/area/results/file"
  if [[ $(id -u) -ne 0 ]]; then
    mkdir -- "$scratch/area/locked"
    chmod a-w -- "$scratch/area/locked"
    Refused "output not writable" 'area/locked' $program --case="$case" \
      --output_dir="$scratch/area/locked/D"
  else
    echo "skipped: output not writable ($program); root may write anywhere"
  fi
  mkdir -- "$output"
  echo "an afternoon's work" >"$output/notes.txt"
  Refused "output not empty" 'results/D: .*not empty' $program \
    --case="$case" --output_dir="$output"
  Refused "output of somebody else" 'results/D: .*no results of pinode' \
    $program --case="$case" --output_dir="$output" --overwrite
done
Refused "resume what is not ours" 'results/D: .*no results of pinode' \
  pinode_update --case="$case" --output_dir="$output" --resume
echo '{}' >"$output/checkpoint.json"
Refused "resume from no checkpoint" 'checkpoint\.json: ' \
  pinode_update --case="$case" --output_dir="$output" --resume

# Flags.
Fresh
for program in pinode_check pinode_update pinode_simulate; do
  Refused "unknown flag" "'--cases'.*did you mean '--case'" $program \
    --cases="$case"
  Refused "stray argument" "'$case' is not a flag; write --case=$case" \
    $program "$case"
done
arguments=(--case="$case" --output_dir="$output")
Refused "records for a case" 'not valid TOML; .*pinode_new drafts a case' \
  pinode_check --case="$input/train.csv"
Refused "text for a number" "'--threads' is 'many', expected a whole" \
  pinode_update \
  "${arguments[@]}" --threads=many
Refused "too few threads" '--threads' pinode_update "${arguments[@]}" \
  --threads=-1
Refused "flag without a value" "'--threads'" pinode_update "${arguments[@]}" \
  --threads
Refused "text for a truth" "'--overwrite'.*'perhaps'" pinode_update \
  "${arguments[@]}" --overwrite=perhaps
Refused "too many threads" '--threads' pinode_update "${arguments[@]}" \
  --threads=99999999999
Refused "NaN for a noise" '--noise_percent' pinode_simulate \
  "${arguments[@]}" --noise_percent=nan

echo "$((trials - failures)) of $trials refusals as expected"
[[ $failures -eq 0 ]]
