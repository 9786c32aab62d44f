#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds everything and runs the tests; the last line says `N passed, M failed`. See tests/README.md.
set -euo pipefail
cd "$(dirname "$0")"
# shellcheck source=docker/machine.sh
. docker/machine.sh

PRESET=release
FILTER=
LONG=
JOBS=$(nproc)

usage() {
  cat <<'TXT'
usage: ./test.sh [--preset release|dev|asan|tsan] [--filter REGEX] [--jobs N] [--long]
  --preset P      build preset (default: release); asan and tsan build with the sanitizers
  --filter REGEX  only the test programs whose name matches (ctest -R); the viewer's own tests if it matches "web"
  --jobs N        tests at a time (default: the number of cores); those that load the machine, and e2e tests, run alone
  --long          also the slow tests (ctest -L long): more scripts in a browser, clang, more builds of the kernel;
                  also builds the benches
CI=true makes every compiler warning an error, and builds the benches.
TXT
}

parse_options() {
  while [ $# -gt 0 ]; do
    case "$1" in
      --preset) PRESET="${2:?--preset needs a name}"; shift 2 ;;
      --filter) FILTER="${2:?--filter needs a pattern}"; shift 2 ;;
      --jobs) JOBS="${2:?--jobs needs a number}"; shift 2 ;;
      --long) LONG=1; shift ;;
      -h|--help) usage; exit 0 ;;
      *) usage >&2; fail "Unknown option: $1" ;;
    esac
  done
  case "$PRESET" in release|dev|asan|tsan) ;; *) fail "Unknown preset: $PRESET" ;; esac
}

# Fetches real NC programs and the reference interpreter rs274 from Debian's LinuxCNC packages (GPL)
# and unpacks them under build/ without installing them. If this fails, the tests that need them are
# skipped with the reason.
fetch_linuxcnc() {
  local dir="$KERF_ROOT/build/linuxcnc" log="$KERF_LOGS/linuxcnc.log"
  mkdir -p "$KERF_LOGS"
  if [ ! -x "$dir/rs274" ] && ! unpack_linuxcnc "$dir" >"$log" 2>&1; then
    echo "LinuxCNC's sample programs could not be fetched (offline? log: $log): the tests that need them skip."
    rm -rf "$dir"
    return
  fi
  export KERF_LINUXCNC_DIR="$dir" PATH="$dir:$PATH"
}

unpack_linuxcnc() (
  local dir="$1" root="$1/root" deb
  rm -rf "$dir" && mkdir -p "$root" && cd "$dir" || return 1
  chmod a+rwx . # apt downloads as its own user
  local packages=(linuxcnc-uspace libboost-python1.74.0 libmodbus5 libpython3.11)
  apt-get download "${packages[@]}" \
    || { as_root apt-get update && apt-get download "${packages[@]}"; } || return 1
  for deb in ./*.deb; do dpkg -x "$deb" "$root" || return 1; done
  rm ./*.deb
  cp "$root/usr/share/linuxcnc/ncfiles/3D_Chips.ngc" . || return 1
  find "$root" -path '*vismach*' -name 'boat-xyzac.ngc' -exec cp {} . \; || return 1
  printf 'T1 P1 D10\nT2 P2 D6\nT3 P3 D3\n' >tool.tbl
  cat >rs274 <<TXT
#!/bin/sh
# LinuxCNC's reference interpreter, not installed, with the libraries beside it and a tool table.
LD_LIBRARY_PATH="$root/usr/lib:$root/usr/lib/$(uname -m)-linux-gnu" exec "$root/usr/bin/rs274" -t "$dir/tool.tbl" "\$@"
TXT
  chmod +x rs274
  printf 'G21 G0 X1\nM2\n' >check.ngc
  ./rs274 -g check.ngc || rm rs274 # a missing library shows in the log, not in a test
)

# run_ctest NAME CTEST-OPTION...: runs one group of tests. Failures are counted at the end, so that
# later groups still run.
run_ctest() {
  local name="$1"
  shift
  say "Tests: $name"
  ctest --test-dir "build/$PRESET" --output-on-failure --no-tests=ignore ${FILTER:+-R "$FILTER"} \
    --output-junit "$RESULTS/ctest-$name.xml" "$@" || true
}

run_web_tests() {
  if [ -n "$FILTER" ] && ! [[ web =~ $FILTER ]]; then return; fi
  say "Tests: web"
  (cd web && npx --no-install vitest run --maxWorkers="$JOBS" --minWorkers=1 --reporter=default --reporter=json \
    --outputFile.json="$RESULTS/vitest.json") || true
  [ -s "$RESULTS/vitest.json" ] || echo '{"numPassedTests":0,"numFailedTests":1}' >"$RESULTS/vitest.json"
}

# Prints the CPU seconds of all ended child processes of this script, as counted by Linux (proc(5)).
cpu_seconds() {
  awk -v hz="$(getconf CLK_TCK)" '{ sub(/^.*\) /, ""); printf "%.1f", ($14 + $15) / hz }' "/proc/$$/stat"
}

# note_cpu NAME BEFORE: records the CPU time used since BEFORE.
note_cpu() { awk -v name="$1" -v now="$(cpu_seconds)" -v before="$2" 'BEGIN { print name, now - before }' >>"$RESULTS/cpu.txt"; }

main() {
  local begin targets=(web all)
  parse_options "$@"
  if [ -n "$LONG${CI:-}" ]; then targets+=(benches); fi
  install_sections build test wasm run
  fetch_linuxcnc
  use_node
  RESULTS="$KERF_ROOT/build/$PRESET/results"
  rm -rf "$RESULTS" && mkdir -p "$RESULTS"
  begin=$(cpu_seconds)
  build_all "$PRESET" -DKERF_TESTS=ON ${CI:+-DKERF_WERROR=ON} -- "${targets[@]}"
  note_cpu build "$begin"
  begin=$(cpu_seconds)
  export GTEST_OUTPUT="xml:$RESULTS/gtest/"
  run_ctest fast -LE 'server|e2e|long' -j "$JOBS"
  run_web_tests
  run_ctest server -L server -j "$JOBS"
  run_ctest e2e -L e2e
  if [ -n "$LONG" ]; then run_ctest long -L long; fi
  note_cpu tests "$begin"
  python3 tests/summary.py "$RESULTS"
}

main "$@"
