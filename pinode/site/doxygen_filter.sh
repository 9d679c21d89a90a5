#!/usr/bin/env bash
# A header as Doxygen reads it: plain comments become its own, the first that of
# the file. Formulas in them keep their layout.
#
#   doxygen_filter.sh HEADER
exec awk '
  # What Doxygen and reStructuredText would take for commands, but for what stands
  # between quotes, which they leave alone; `names`, which may go on in the next
  # line, are code.
  function Plain(text,   parts, count, i, plain) {
    count = split(text, parts, "\"")
    for (i = 1; i <= count; ++i) {
      # Of quotes that are one too many the last is none.
      if (i % 2 == 1 || i == count) {
        gsub(/[\\@]/, "\\\\&", parts[i])
        gsub(/</, "\\&lt;", parts[i])
      }
      plain = plain (i > 1 ? "\"" : "") parts[i]
    }
    while (sub(/`/, is_code ? "</tt>" : "<tt>", plain)) is_code = !is_code
    return plain
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
