#!/usr/bin/env bash
# A header as Doxygen reads it: plain comments become its own, the first that of
# the file. Formulas in them keep their layout.
#
#   doxygen_filter.sh HEADER
exec awk '
  # What Doxygen and reStructuredText would take for commands; `names`, which may
  # go on in the next line, are code.
  function Plain(text) {
    gsub(/[\\@]/, "\\\\&", text)
    gsub(/</, "\\&lt;", text)
    while (sub(/`/, is_code ? "</tt>" : "<tt>", text)) is_code = !is_code
    return text
  }
  FNR == 1 && /^\/\// { print "/// \\file" }
  match($0, /^ *\/\/( |$)/) {
    print substr($0, 1, RLENGTH - ($0 ~ /\/\/ /)) "/" \
      Plain(substr($0, RLENGTH + ($0 !~ /\/\/ /)))
    next
  }
  match($0, /[;,{] +\/\/ /) {
    print substr($0, 1, RSTART) " ///< " Plain(substr($0, RSTART + RLENGTH))
    next
  }
  { is_code = 0; print }
' "$1"
