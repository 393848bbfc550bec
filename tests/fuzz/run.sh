#!/bin/sh
# Build the fuzzers with clang and run them one after the other. scripts/setup must have built the
# engine into build/.
#
#   tests/fuzz/run.sh SECONDS [NAME...]       each so long, from what earlier runs have collected
#   tests/fuzz/run.sh --runs N [NAME...]      N inputs each, drawn with a fixed seed from the seeds
#
# NAME is what follows fuzz_ in the name of a program; left out: all. FUZZ_BUILD is the build folder
# (build-fuzz). Findings are left in FUZZ_BUILD/findings/NAME; keep each as a file in
# tests/fuzz/seeds/NAME, which makes it a test. Ends with status 1 when there is one.
set -eu
usage="usage: tests/fuzz/run.sh SECONDS|--runs N [NAME...]"
amount=${1:?$usage}
shift
if [ "$amount" = --runs ]; then
  runs=${1:?$usage}
  shift
else
  runs=
fi
root=$(cd "$(dirname "$0")/../.." && pwd)
build=${FUZZ_BUILD:-$root/build-fuzz}
all=$(cd "$root/tests/fuzz" && ls fuzz_*.c | sed 's/^fuzz_//; s/\.c$//')
names=${*:-$all}
mkdir -p "$build"
if ! CC=clang cmake -G Ninja -S "$root" -B "$build" -DBARWRIGHT_FUZZ=ON >"$build/configure.log" 2>&1; then
  cat "$build/configure.log"
  exit 1
fi
targets=""
for name in $names; do targets="$targets fuzz_$name"; done
if ! ninja -C "$build" $targets >"$build/build.log" 2>&1; then
  tail -n 40 "$build/build.log"
  exit 1
fi
found=0
for name in $names; do
  corpus=$build/corpus/$name
  limit=-max_total_time=$amount
  if [ -n "$runs" ]; then
    corpus=$build/corpus-of-runs/$name
    rm -rf "$corpus"
    limit="-runs=$runs -seed=1"
  fi
  log=$build/fuzz_$name.log
  mkdir -p "$corpus" "$build/findings/$name"
  if ! "$build/fuzz/fuzz_$name" $limit -rss_limit_mb=2048 -timeout=60 -max_len=8192 -print_final_stats=1 \
    -artifact_prefix="$build/findings/$name/" "$corpus" "$root/tests/fuzz/seeds/$name" >"$log" 2>&1; then
    found=1
    echo "fuzz_$name: FOUND something, see $log"
    grep -m 3 -E "ERROR|SUMMARY|Test unit" "$log" || true
  fi
  echo "fuzz_$name: $(sed -n 's/^stat::number_of_executed_units: *//p' "$log") inputs"
done
exit $found
