# Sourced by the tests of programs. `programs` names the folder that holds them,
# `tested` the one that Refused calls.

Fail() {
  echo "$1"
  [[ ! -s stdout ]] || cat stdout
  [[ ! -s stderr ]] || cat stderr
  exit 1
}

# Run STATUS PROGRAM ARGUMENT...
Run() {
  local expected=$1 program=$2 status=0
  shift 2
  "$programs/$program" "$@" >stdout 2>stderr || status=$?
  [[ $status -eq $expected ]] ||
    Fail "$program $*: status $status, expected $expected"
}

# Refused TEXT ARGUMENT...: one line on standard error that holds TEXT, and
# nothing written, in no folder E either.
Refused() {
  local text=$1
  shift
  Run 2 "$tested" "$@"
  [[ $(wc -l <stderr) -eq 1 ]] || Fail "expected one line"
  grep -qF -- "$text" stderr || Fail "expected '$text'"
  [[ ! -s stdout && ! -e E ]] || Fail "something was written"
}

# "name change damaged p_value" of each group in the damage.json of a folder.
Groups() {
  awk '
    /"groups": \[/ { inside = 1 }
    inside && /^  ]/ { exit }
    inside {
      gsub(/[",:]/, " ")
      if ($1 == "name") name = $2
      if ($1 == "change") change = $2
      if ($1 == "damaged") damaged = $2
      if ($1 == "p_value") print name, change, damaged, $2
    }' "$1/damage.json"
}
