#!/usr/bin/env bash
# The manual page and the completion of a program name all its flags, values as
# they are.
#
#   tests/program_documents_test.sh PROGRAM FOLDER
#
# FOLDER holds PROGRAM.1, where help2man has made it, and PROGRAM.completion.
# The flags are those that the program itself takes, by gflags' own list, not
# by --help, which the two are made from.
set -euo pipefail

program=$1
folder=$2
name=$(basename -- "$program")

Fail() {
  echo "$name: $1"
  exit 1
}

# Of all that gflags and glog define, those that source files of apps/ do.
mapfile -t flags < <(
  cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../apps"
  grep -hoP '^DEFINE_\w+\(\K\w+' "$name.cc"
  grep -q -e '"apps/fit_flags.h"' -e '^DECLARE_string(case)' "$name.cc" &&
    grep -hoP '^DEFINE_\w+\(\K\w+' fit_flags.cc
  ! grep -q '"apps/deck_flag.h"' "$name.cc" ||
    grep -hoP '^DEFINE_\w+\(\K\w+' deck_flag.cc
)
flags+=(help version v vmodule)
[[ ${#flags[@]} -gt 5 ]] || Fail "expected more flags than ${flags[*]}"

completion=$folder/$name.completion
bash -n "$completion" || Fail "its completion is no script"
offered=$(
  # What bash-completion brings, in so far as it is asked for here.
  _init_completion() { cur=$COMP_CUR prev=; }
  _filedir() { :; }
  compopt() { :; }
  source "$completion"
  COMP_CUR=--
  "_$name" || true
  printf '%s\n' "${COMPREPLY[@]}"
)
for flag in "${flags[@]}"; do
  grep -qx -e "--$flag=\?" <<<"$offered" ||
    Fail "its completion does not offer --$flag"
done

# Of the value of a flag, which bash completes with files or folders.
Completes() {
  (
    flag=$1
    _init_completion() { cur='' prev=$flag; }
    _filedir() { echo "files $*"; }
    source "$completion"
    "_$name"
  )
}
folder_flag=--output_dir
if [[ $name == pinode_app ]]; then
  folder_flag=--folder
else
  file_flag=--case
  if [[ $name == pinode_watch ]]; then
    file_flag=--structure
  fi
  [[ $(Completes $file_flag) == "files " ]] ||
    Fail "no files are offered for $file_flag"
fi
[[ $(Completes $folder_flag) == "files -d" ]] ||
  Fail "no folders are offered for $folder_flag"
if [[ $name == pinode_update && $(Completes --deck) != "files " ]]; then
  Fail "no files are offered for --deck"
fi

help=$("$program" --help)
wrong=$(grep -E '^  --[^[]*\]' <<<"$help" || true)
[[ -z $wrong ]] || Fail "a bracket belongs to no value: $wrong"
wrong=$(grep -E '[0-9]{15}' <<<"$help" || true)
[[ -z $wrong ]] || Fail "more digits than were given: $wrong"
# The one with the packages, the other in the source tree.
for document in case_files.md pinode/case/README.md; do
  grep -q -F "$document" <<<"$help" || Fail "--help does not name $document"
done

page=$folder/$name.1
[[ -f $page ]] || exit 0
# Dashes are escaped in the page.
text=$(sed 's/\\-/-/g; s/\\f.//g' "$page")
for flag in "${flags[@]}"; do
  grep -q -e "^--$flag\($\|[^a-z_]\)" <<<"$text" ||
    Fail "its page does not have --$flag"
done
grep -q "^$name - [a-z]" <<<"${text//\\/}" ||
  Fail "its page has no line for apropos"
for section in SYNOPSIS DESCRIPTION 'SEE ALSO'; do
  grep -q "^.SH \"\?$section" "$page" || Fail "its page has no $section"
done
if command -v man >/dev/null; then
  wrong=$(MANROFFSEQ='' MANWIDTH=80 LC_ALL=C.UTF-8 \
    man --warnings -E UTF-8 -l "$page" 2>&1 >/dev/null)
  [[ -z $wrong ]] || Fail "its page: $wrong"
fi
