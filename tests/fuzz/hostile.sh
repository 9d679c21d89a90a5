#!/usr/bin/env bash
# Gives the programs inputs that nobody would write on purpose, and counts what
# they did.
#
#   tests/fuzz/hostile.sh BUILD_DIR
#
# Every number of the cases in tests/fuzz/hostile takes each value of `extremes`
# in its turn, and each of these cases goes to the programs that its second line
# names. Prints the counts, and a line for each case that crashed (ended by a
# signal), hung (did not end a minute after a time limit's SIGTERM) or wrote several
# lines on standard error at status 2. Exits 1 if there is one. A case that
# failed stays in BUILD_DIR/hostile.
#
# HOSTILE_KEYS=REGEX takes only lines that match it.
set -euo pipefail

if [[ $# -ne 1 ]]; then
  sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//;p}' "$0" >&2
  exit 2
fi
cases=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/hostile" && pwd)
build=$(cd -- "$1" && pwd)
keys=${HOSTILE_KEYS:-.}
# Seconds before SIGTERM, and from there to SIGKILL. A fit ends after the
# iteration, which a model of 1000 steps a sample makes long.
patience=${HOSTILE_PATIENCE:-20}
grace=${HOSTILE_GRACE:-60}
# Memory in kB. The allocator's own reserve for threads is part of it.
memory=${HOSTILE_MEMORY:-4000000}
extremes=(0 1 -1 1000 1000000 1070000000 2000000000 2147483647 2147483648
  4294967297 -2147483648 9223372036854775807 -9223372036854775808 0.5 1e-308
  1e308 -1e308 inf nan)

work=$build/hostile
rm -rf -- "$work"
mkdir -p -- "$work/run"
cd -- "$work/run"

# A motion of 1000 samples with two frequencies, and noise.
awk 'BEGIN {
  print "t,ag,F,T,a1,a2"
  for (k = 0; k < 1000; ++k) {
    t = k / 100
    slow = sin(12 * t)
    fast = sin(31.7 * t + 1)
    a1 = slow + 0.4 * fast + 0.3 * sin(k * k)
    a2 = 1.6 * slow - 0.3 * fast + 0.3 * cos(k * k)
    printf "%.2f,%.9f,%.9f,%.4f,%.9f,%.9f\n", t, 0.1 * sin(7 * t),
      3 * cos(9 * t), 15 + t, a1, a2
  }
}' >record.csv
mkdir records
for day in 01 02 03; do cp record.csv "records/r_202401$day.csv"; done
# Records are known by their content: each lacks another one of the last lines.
sed -i '1000d' records/r_20240102.csv
sed -i '1001d' records/r_20240103.csv
printf 'day,wind\n2024-01-01,3\n2024-01-02,4\n2024-01-04,5\n' >wind.csv
printf 'u1,u2,u3\n0.4,0.8,1\n' >shapes.csv
# The accelerance of an oscillator of 2.6 Hz at 80 lines.
awk 'BEGIN {
  print "Frequency\tReal\tImaginary"
  for (k = 1; k <= 80; ++k) {
    r = k * 0.25 / 2.6
    re = 1 - r * r
    im = 0.04 * r
    size = 0.0005 * r * r / (re * re + im * im)
    printf "%.2f\t%.9g\t%.9g\n", 0.25 * k, -size * re, size * im
  }
}' >frf.txt
header='%%MatrixMarket matrix coordinate real symmetric'
printf '%s\n4 4 4\n1 1 2\n2 2 2\n3 3 2\n4 4 1\n' "$header" >M.mtx
for first in 2000 2100; do
  name=$([[ $first == 2000 ]] && echo K || echo K1)
  printf '%s\n4 4 7\n1 1 %d\n2 1 -1000\n2 2 2000\n3 2 -1000\n3 3 2000\n4 3 -1000\n4 4 1000\n' \
    "$header" "$first" >"$name.mtx"
done

ran=0 not_usable=0 refused=0 interrupted=0 crashed=0 hung=0 several=0

# Runs a program on case.toml and counts the result; $1: program, $2: its name
# in the list of findings.
run() {
  local program=$1 what=$2 status=0 finding= lines
  local flags=(--case=case.toml)
  [[ $program == pinode_check ]] || flags+=(--output_dir=out)
  if [[ $program == pinode_watch ]]; then
    [[ -x $build/apps/$program ]] || return 0
    flags=(--structure=case.toml --store=out/watch.db --once --output_dir=out/D)
    mkdir -p out
  fi
  # bash itself would say on its standard error how a program ended.
  { (ulimit -v "$memory" && exec timeout -k "$grace" "$patience" \
    "$build/apps/$program" "${flags[@]}" >stdout 2>stderr </dev/null); } \
    2>/dev/null || status=$?
  ran=$((ran + 1))
  lines=$(wc -l <stderr)
  case $status in
    0) ;;
    1) not_usable=$((not_usable + 1)) ;;
    2)
      refused=$((refused + 1))
      if [[ $lines -ne 1 ]]; then
        several=$((several + 1))
        finding="$lines lines"
      fi
      ;;
    # Status 124 is that of `timeout`, whatever the program's own one was.
    3 | 124) interrupted=$((interrupted + 1)) ;;
    137)
      hung=$((hung + 1))
      finding=hung
      ;;
    *)
      crashed=$((crashed + 1))
      finding="status $status"
      ;;
  esac
  if [[ -n $finding ]]; then
    echo "$finding: $program, $what"
    cp case.toml "../finding_$ran.toml"
  fi
  rm -rf -- out out.partial-*
}

combinations=0
for file in "$cases"/*.toml; do
  name=$(basename -- "$file")
  read -ra programs <<<"$(sed -n '2s/^# //p' "$file")"
  cp -- "$file" case.toml
  for program in "${programs[@]}"; do run "$program" "$name as it is"; done
  # Prints "line position length" of each number outside of quotes and names.
  while read -r line position length; do
    for value in "${extremes[@]}"; do
      awk -v line="$line" -v position="$position" -v size="$length" \
        -v value="$value" 'NR == line {
          $0 = substr($0, 1, position - 1) value substr($0, position + size)
        } { print }' "$file" >case.toml
      combinations=$((combinations + 1))
      for program in "${programs[@]}"; do
        run "$program" "$name:$line: $(sed -n "${line}p" case.toml)"
      done
    done
  done < <(awk -v keys="$keys" '$0 ~ keys && /=/ && !/^#/ {
    rest = $0
    gsub(/"[^"]*"/, "", rest)  # only to skip lines without numbers
    if (rest !~ /[^a-z_0-9][0-9]/) next
    at = 1
    quoted = 0
    while (at <= length($0)) {
      c = substr($0, at, 1)
      if (c == "\"") quoted = !quoted
      before = at > 1 ? substr($0, at - 1, 1) : " "
      if (!quoted && before !~ /[A-Za-z_0-9.]/ &&
          match(substr($0, at), /^-?[0-9][0-9.]*(e-?[0-9]+)?/)) {
        print NR, at, RLENGTH
        at += RLENGTH
      } else {
        at += 1
      }
    }
  }' "$file")
done

echo "$combinations cases, $ran runs: $refused refused, $not_usable not" \
  "usable, $interrupted interrupted by the time limit, $crashed crashed," \
  "$hung hung, $several with several lines at status 2"
[[ $((crashed + hung + several)) -eq 0 ]]
