#!/usr/bin/env bash
# The blocks of MATLAB in pinode/matlab.md, run by Octave one after the other with
# the programs, which read what the first writes; its case is the page's own.
#
#   tests/programs/octave_test.sh PROGRAM_DIR
#
# Skipped (77) without octave-cli, or where it has no font to plot with.
set -euo pipefail

programs=$(cd -- "$1" && pwd)
page=$(cd -- "$(dirname -- "$0")/../../pinode" && pwd)/matlab.md
if ! command -v octave-cli >/dev/null; then
  echo "skipped: no octave-cli, blocks of MATLAB are not run (apt-get install octave)"
  exit 77
fi
scratch=$(mktemp -d)
trap 'rm -rf -- "$scratch"' EXIT
cd -- "$scratch"
export PATH=$programs:$PATH

Octave() {
  octave-cli --norc --no-history --quiet "$1"
}

echo "set(0, 'defaultfigurevisible', 'off'); plot(1:2);" >can_plot.m
if ! Octave can_plot.m >plot.log 2>&1; then
  echo "skipped: Octave cannot plot (apt-get install fonts-freefont-otf):"
  tail -5 plot.log
  exit 77
fi

# block_1.m, block_2.m, ... and the one case.
awk '/^```/ {
       file = ""
       if ($0 == "```matlab") file = "block_" ++blocks ".m"
       if ($0 == "```toml") { file = "frame.toml"; ++cases }
       next
     }
     file { print > file }
     END { print blocks, cases > "found" }' "$page"
read -r blocks cases <found
[[ $blocks -eq 3 && $cases -eq 1 ]] || {
  echo "$page: $blocks blocks of MATLAB and $cases cases, expected 3 and 1"
  exit 1
}

cat >blocks.m <<'END'
set(0, 'defaultfigurevisible', 'off');
randn('seed', 1);
source block_1.m
source block_2.m
% A tenth of the first storey was lost, and nothing of the others.
truth = [-0.1; 0; 0];
assert(strcmp(r.parameters.name, {'k1'; 'k2'; 'k3'}));
assert(all(truth > r.parameters.value - 4 * r.parameters.sigma));
assert(all(truth < r.parameters.value + 4 * r.parameters.sigma));
assert(norm(r.K - true_K) < 0.01 * norm(true_K));
assert(numel(p.time) == numel(t) && numel(get(gca, 'children')) == 2);
assert(strcmp(outcome.termination, 'converged') && outcome.usable);
source block_3.m
assert(norm(c.K - K) < 1e-9 * norm(K) && norm(c.M - M) < 1e-9 * norm(M));
assert(norm(c.modes.frequency_hz - sqrt(eig(K, M)) / (2 * pi)) < 1e-6);
assert(isempty(about.undetermined) && numel(c.expected.sigma) == 3);
printf('all blocks have run\n');
END
Octave blocks.m >octave.log 2>&1 || {
  cat octave.log
  exit 1
}
# What the blocks print.
for line in 'converged' 'k1 .*95 %: .* to ' 'k3 .*to be found within' \
  'all blocks have run'; do
  grep -q "$line" octave.log || {
    cat octave.log
    echo "expected a line '$line'"
    exit 1
  }
done
