#!/usr/bin/env bash
# Checks that every #include keeps to the floors.
#
#   tests/floors_check.sh ROOT
#
# A folder of pinode/ includes itself and folders on lower floors; folders on
# the same floor do not see each other. Within a folder, a room (sub-folder)
# includes itself and the rooms before it; "." is the folder itself. The one file
# at the root is pinode/pinode.h: it may include every folder, programs may
# include it, and no file of pinode/ may. Unit tests
# may include any room of their folder, and the kits of tests/support.
# Includes of the project are written from its root, so that none escapes this
# check. Third parties that have one
# door: gflags in apps/, glog in pinode/base/logging.h, toml++ in pinode/case,
# MPI in pinode/mpi, pybind11 in pinode/python, httplib in pinode/app, SQLite and
# libcurl in pinode/watch.
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
    floor["problem"] = 4
    floor["estimate"] = 5
    floor["discover"] = floor["damage"] = 6
    floor["study"] = 7
    floor["case"] = floor["report"] = floor["mpi"] = 8
    floor["watch"] = 9
    floor["app"] = floor["python"] = 10
    # Rooms of a folder, lowest first. A folder without an entry has none.
    rooms["base"] = ". arrays"
    rooms["structure"] = "model sparse matrices decks"
    rooms["record"] = ". files frf"
    rooms["modal"] = ". frf"
    rooms["integrate"] = ". periodic"
    rooms["estimate"] = "solver shooting start ambient frf objective certainty fit ."
    rooms["study"] = "problem reduction terms explanations identify laws sensors damage picture"
    rooms["case"] = "text sections draft results run"
    rooms["python"] = "binding"
    # A fixed order, so that the message is the same everywhere.
    count = split("base structure record network dynamics modal integrate " \
                  "problem estimate discover damage study case report mpi watch app python", folders, " ")
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

  # The place of `room` in the order of its folder, 0 where it has none.
  function RoomPlace(folder, room,   i, n, order) {
    n = split((folder in rooms) ? rooms[folder] : ".", order, " ")
    for (i = 1; i <= n; ++i) {
      if (order[i] == room) return i
    }
    return 0
  }

  # own, other: rooms of `folder`.
  function CheckRooms(folder, own, other, header,   from, to) {
    from = RoomPlace(folder, own)
    to = RoomPlace(folder, other)
    if (to == 0) {
      Fail("includes " header ", expected a room of pinode/" folder)
    } else if (FILENAME !~ /_test\.cc$/ && from > 0 && to > from) {
      Fail("pinode/" folder "/" own " includes " header \
           ", expected only rooms before it: " rooms[folder])
    }
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
    if (header == "httplib.h" && FILENAME !~ /^pinode\/app\//) {
      Fail("includes " header ", expected httplib in pinode/app only")
    }
    if (header == "sqlite3.h" && FILENAME !~ /^pinode\/watch\/store(_[a-z]+)?\.(cc|h)$/) {
      Fail("includes " header ", expected pinode/watch/store*")
    }
    if (header ~ /^curl\// && FILENAME != "pinode/watch/courier.cc") {
      Fail("includes " header ", expected pinode/watch/courier.cc")
    }
    if (header == "mpi.h" && FILENAME !~ /^pinode\/mpi\//) {
      Fail("includes " header ", expected pinode/base/communicator.h")
    }
  }

  # header: as written between the quotes or angle brackets.
  function CheckProject(header, quoted,   top, own, own_room, part, other,
                        other_room) {
    split(FILENAME, part, "/")
    top = part[1]
    own = part[2]
    own_room = (4 in part) ? part[3] : "."
    delete part
    split(header, part, "/")
    other = part[2]
    other_room = (4 in part) ? part[3] : "."
    if (part[1] == "pinode") {
      if (!quoted) {
        Fail("includes <" header ">, expected quotes around our own header")
      }
      if (header == "pinode/pinode.h") {
        if (top == "pinode") {
          Fail("the library includes " header ", which is for programs, " \
               "expected the headers that are needed")
        }
      } else if (!(other in floor)) {
        Fail("includes " header ", expected a folder of the floors table")
      } else if (top == "pinode" && (own in floor) && own != other &&
                 floor[other] >= floor[own]) {
        Fail("pinode/" own " includes " header \
             ", expected only headers of " Allowed(own))
      } else if (top == "pinode" && own == other) {
        CheckRooms(own, own_room, other_room, header)
      }
    } else if (top == "pinode" && (part[1] == "apps" || part[1] == "tests") &&
               !(FILENAME ~ /_test\.cc$/ && header ~ /^tests\/support\//)) {
      Fail("the library includes " header ", expected only pinode/")
    } else if (quoted && (header !~ /\// || header ~ /\.\./ ||
                          part[1] in floor)) {
      Fail("includes \"" header "\", expected the path from the project " \
           "root, or angle brackets")
    }
  }

  FNR == 1 && FILENAME ~ /^pinode\// {
    delete place
    split(FILENAME, place, "/")
    if (FILENAME == "pinode/pinode.h") {
      # Of no folder.
    } else if (!(place[2] in floor)) {
      Fail("lies in pinode/" place[2] ", expected a folder of the floors table")
    } else if (RoomPlace(place[2], (4 in place) ? place[3] : ".") == 0) {
      Fail("lies in " FILENAME ", expected a room of pinode/" place[2] ": " \
           ((place[2] in rooms) ? rooms[place[2]] : "none"))
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
