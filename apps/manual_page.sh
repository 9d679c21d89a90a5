#!/usr/bin/env bash
# Prints the manual page of a program, made from what it says with --help and
# --version by help2man (Debian: help2man).
#
#   apps/manual_page.sh PROGRAM
set -euo pipefail

program=$1
scratch=$(mktemp -d)
trap 'rm -rf -- "$scratch"' EXIT

# The line that apropos shows: the first sentence, as far as its first
# semicolon, in small letters.
name=$("$program" --help | awk '
  /^$/ { ++paragraph }
  paragraph == 1 { text = text " " $0 }
  END {
    sub(/^ +/, "", text)
    sub(/[.;].*/, "", text)
    print tolower(substr(text, 1, 1)) substr(text, 2)
  }')

cat >"$scratch/include" <<END
[FILES]
The case file and what a result folder holds are described in
.IR case_files.md ,
beside the other documents of pinode.

[SEE ALSO]
.BR pinode_new (1),
.BR pinode_check (1),
.BR pinode_simulate (1),
.BR pinode_update (1),
.BR pinode_discover (1),
.BR pinode_damage (1),
.BR pinode_modes (1),
.BR pinode_watch (1),
.BR pinode_app (1)
END

help2man --no-info --name="$name" --include="$scratch/include" \
  --source="pinode" "$program"
