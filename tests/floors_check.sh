#!/usr/bin/env bash
# Checks that every #include keeps to the floors.
#
#   tests/floors_check.sh ROOT
#
# A folder of pinode/ includes itself and folders on lower floors; folders on
# the same floor do not see each other. Includes of the project are written
# from its root, so that none escapes this check. Third parties that have one
# door: gflags in apps/, glog in pinode/base/logging.h, toml++ in pinode/case,
# MPI in pinode/mpi, pybind11 in pinode/python.
#
# Prints `file:line: what, and what was expected` for each violation and exits
# 1 if there is one; exits 2 if there is nothing to check.
set -euo pipefail

if [[ $# -ne 1 || ! -d $1/pinode ]]; then
  echo "usage: $0 ROOT, a folder that holds pinode/" >&2
  exit 2
fi
cd -- "$1"

folders=()
for folder in pinode apps tests data; do
  if [[ -d $folder ]]; then folders+=("$folder"); fi
done

# The fixture of floors_check_test.sh is made of violations.
mapfile -t files < <(find "${folders[@]}" -path tests/floors_fixture -prune -o \
  -type f \( -name '*.h' -o -name '*.hpp' -o -name '*.cc' -o -name '*.cpp' \) \
  -print | LC_ALL=C sort)
if [[ ${#files[@]} -eq 0 ]]; then
  echo "$0: no source file under $1" >&2
  exit 2
fi

awk '
  BEGIN {
    floor["base"] = 0
    floor["structure"] = floor["record"] = floor["network"] = 1
    floor["dynamics"] = floor["modal"] = 2
    floor["integrate"] = 3
    floor["estimate"] = 4
    floor["discover"] = floor["damage"] = 5
    floor["study"] = 6
    floor["case"] = floor["report"] = floor["mpi"] = 7
    floor["python"] = 8
    # A fixed order, so that the message is the same everywhere.
    count = split("base structure record network dynamics modal integrate " \
                  "estimate discover damage study case report mpi python", folders, " ")
  }

  function Fail(message) {
    print FILENAME ":" FNR ": " message
    failed = 1
  }

  # The folders that `folder` may include, as words.
  function Allowed(folder,   i, words) {
    words = "pinode/" folder
    for (i = 1; i <= count; ++i) {
      if (floor[folders[i]] < floor[folder]) {
        words = words ", pinode/" folders[i]
      }
    }
    return words
  }

  function CheckThirdParty(header) {
    if (header ~ /^gflags\// && FILENAME !~ /^apps\//) {
      Fail("includes " header ", expected gflags in apps/ only")
    }
    if (header ~ /^glog\// && FILENAME != "pinode/base/logging.h") {
      Fail("includes " header ", expected pinode/base/logging.h")
    }
    if (header ~ /^toml(\+\+)?[.\/]/ && FILENAME !~ /^pinode\/case\//) {
      Fail("includes " header ", expected toml++ in pinode/case only")
    }
    if (header ~ /^pybind11\// && FILENAME !~ /^pinode\/python\//) {
      Fail("includes " header ", expected pybind11 in pinode/python only")
    }
    if (header == "mpi.h" && FILENAME !~ /^pinode\/mpi\//) {
      Fail("includes " header ", expected pinode/base/communicator.h")
    }
  }

  # header: as written between the quotes or angle brackets.
  function CheckProject(header, quoted,   top, own, part, other) {
    split(FILENAME, part, "/")
    top = part[1]
    own = part[2]
    split(header, part, "/")
    other = part[2]
    if (part[1] == "pinode") {
      if (!quoted) {
        Fail("includes <" header ">, expected quotes around our own header")
      }
      if (!(other in floor)) {
        Fail("includes " header ", expected a folder of the floors table")
      } else if (top == "pinode" && (own in floor) && own != other &&
                 floor[other] >= floor[own]) {
        Fail("pinode/" own " includes " header \
             ", expected only headers of " Allowed(own))
      }
    } else if (top == "pinode" && (part[1] == "apps" || part[1] == "tests")) {
      Fail("the library includes " header ", expected only pinode/")
    } else if (quoted && (header !~ /\// || header ~ /\.\./ ||
                          part[1] in floor)) {
      Fail("includes \"" header "\", expected the path from the project " \
           "root, or angle brackets")
    }
  }

  FNR == 1 && FILENAME ~ /^pinode\// {
    split(FILENAME, place, "/")
    if (!(place[2] in floor)) {
      Fail("lies in pinode/" place[2] ", expected a folder of the floors table")
    }
  }

  /^[ \t]*#[ \t]*include/ {
    quoted = ($0 ~ /include[ \t]*"/)
    header = $0
    if (!sub(/^[ \t]*#[ \t]*include[ \t]*["<]/, "", header)) next
    sub(/[">].*$/, "", header)
    CheckThirdParty(header)
    CheckProject(header, quoted)
  }

  END { exit failed }
' "${files[@]}"
