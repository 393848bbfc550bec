#!/bin/sh
# Build the fuzzers with clang and run them one after the other:
#   tests/fuzz/run.sh SECONDS [FORMAT...]
# Findings are left in build-fuzz/findings/FORMAT; keep each as a file in tests/fuzz/seeds/FORMAT,
# which makes it a test. Ends with status 1 when there is one.
set -eu
seconds=${1:?usage: tests/fuzz/run.sh SECONDS [FORMAT...]}
shift
root=$(cd "$(dirname "$0")/../.." && pwd)
formats=${*:-stl obj off ply msh vtu medit tetgen inp tgf svg dxf bwm}
build=$root/build-fuzz
CC=clang CXX=clang++ cmake -G Ninja -S "$root" -B "$build" -DBARWRIGHT_FUZZ=ON >/dev/null
targets=""
for format in $formats; do targets="$targets fuzz_$format"; done
ninja -C "$build" $targets
found=0
for format in $formats; do
  mkdir -p "$build/corpus/$format" "$build/findings/$format"
  echo "fuzz_$format: $seconds s"
  if ! "$build/fuzz/fuzz_$format" -max_total_time="$seconds" -rss_limit_mb=2048 -timeout=10 \
      -max_len=8192 -print_final_stats=1 -verbosity=1 \
      -artifact_prefix="$build/findings/$format/" "$build/corpus/$format" \
      "$root/tests/fuzz/seeds/$format" >"$build/fuzz_$format.log" 2>&1; then
    found=1
    echo "fuzz_$format: FOUND something, see $build/fuzz_$format.log"
    grep -m 3 -E "ERROR|SUMMARY|Test unit" "$build/fuzz_$format.log" || true
  fi
  grep -E "stat::(number_of_executed_units|peak_rss_mb)" "$build/fuzz_$format.log" || true
done
exit $found
