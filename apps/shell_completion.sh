#!/usr/bin/env bash
# Prints the completion of a program's flags for bash, made from what the
# program says with --help.
#
#   apps/shell_completion.sh PROGRAM
#
# A flag whose value --help calls FILE is completed with files, and so are the
# arguments of a program that takes LOG...; FOLDER... is completed with folders;
# a flag without a value also as --noflag.
set -euo pipefail

program=$1
command=$(basename -- "$program")

"$program" --help | awk -v command="$command" '
  /^Usage: .* LOG/ { takes_files = 1 }
  /^  --/ {
    flag = $1
    equals = index(flag, "=")
    if (equals == 0) {
      switches = switches " " flag
      if (flag != "--help" && flag != "--version")
        switches = switches " --no" substr(flag, 3)
      next
    }
    value = substr(flag, equals + 1)
    flag = substr(flag, 1, equals - 1)
    valued = valued " " flag "="
    if (value ~ /^FILE/) files = files "|" flag
    else if (value ~ /^FOLDER/) folders = folders "|" flag
    else others = others "|" flag
  }
  END {
    name = "_" command
    print "# bash completion of " command ", made from its --help."
    print name "() {"
    print "  local cur prev words cword split"
    print "  _init_completion -s || return"
    print "  case $prev in"
    if (files) print "    " substr(files, 2) ") _filedir; return ;;"
    if (folders) print "    " substr(folders, 2) ") _filedir -d; return ;;"
    if (others) print "    " substr(others, 2) ") return ;;"
    print "  esac"
    if (takes_files) print "  [[ $cur == -* ]] || { _filedir; return; }"
    print "  COMPREPLY=($(compgen -W \"" \
      substr(valued switches, 2) "\" -- \"$cur\"))"
    print "  [[ ${COMPREPLY-} == *= ]] && compopt -o nospace"
    print "} &&"
    print "  complete -F " name " " command
  }'
