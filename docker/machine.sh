#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Functions of run.sh, test.sh and the Dockerfile: install packages on Debian 12, build the viewer and the programs, and
# report which step failed. Sourced from the repository's root, or run as a program: `docker/machine.sh install build`.

KERF_ROOT="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
KERF_LOGS="$KERF_ROOT/build/logs"

say() { if [ -t 1 ]; then printf '\033[1m%s\033[0m\n' "$*"; else printf '%s\n' "$*"; fi; }
fail() { printf '%s\n' "$*" >&2; exit 1; }

# step "description" NAME COMMAND...: runs a command with its output in build/logs/NAME.log. A terminal shows the newest
# line; after a failure the end of the log is printed. (A pipe rather than a background job, which would ignore Ctrl-C.)
step() {
  local what="$1" log="$KERF_LOGS/$2.log" begin=$SECONDS rc=0
  shift 2
  mkdir -p "$KERF_LOGS"
  printf '%s … ' "$what"
  if [ -t 1 ]; then
    printf '\n'
    "$@" 2>&1 </dev/null | tee "$log" | awk '{ printf "\r\033[K  %.90s", $0; fflush() } END { printf "\r\033[K" }' || rc=$?
  else
    "$@" >"$log" 2>&1 </dev/null || rc=$?
  fi
  if [ $rc != 0 ]; then
    printf 'FAILED\n'
    tail -n 40 "$log" >&2
    fail "This step failed (exit $rc): $what. Its whole log: $log"
  fi
  printf 'done (%d s)\n' $((SECONDS - begin))
}

# Prints the packages of the named sections, one per line.
packages_of() {
  local section
  for section in "$@"; do
    sed -n "/^\[$section\]/,/^\[/{/^[^[#]/p}" "$KERF_ROOT/docker/packages.txt"
  done
}

# Prints the missing packages of the named sections.
packages_missing() {
  local package
  packages_of "$@" | while read -r package; do
    dpkg-query -W -f '${db:Status-Abbrev}' "$package" 2>/dev/null | grep -q '^ii' || echo "$package"
  done
}

as_root() {
  if [ "$(id -u)" = 0 ]; then "$@"; else
    command -v sudo >/dev/null || fail "Packages are missing; run this as root, or install sudo: $*"
    sudo "$@"
  fi
}

apt_install() {
  as_root apt-get update
  as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends "$@"
}

# Installs the missing packages of the named sections. Calls apt only if any are missing, so that it
# also works offline.
install_sections() {
  local missing
  mapfile -t missing < <(packages_missing "$@")
  if [ ${#missing[@]} -gt 0 ]; then
    step "Installing ${#missing[@]} Debian packages (${missing[*]})" apt apt_install "${missing[@]}"
  fi
}

node_is_new_enough() {
  command -v node >/dev/null && node -e '
    const [a, b] = process.versions.node.split(".").map(Number);
    process.exit(a > 22 || (a === 22 && b >= 12) || (a === 20 && b >= 19) ? 0 : 1)'
}

# Puts a node that Vite accepts (20.19 or later) first on the PATH: the machine's own, or node 22
# from npm.
use_node() {
  if ! command -v npm >/dev/null; then install_sections node; fi
  if node_is_new_enough; then return; fi
  if [ ! -x "$KERF_ROOT/build/node/node_modules/.bin/node" ]; then
    mkdir -p "$KERF_ROOT/build/node"
    step "Fetching node 22 from npm (the installed one is older than Vite requires)" node \
      npm install --prefix "$KERF_ROOT/build/node" --no-audit --no-fund node@22
  fi
  PATH="$KERF_ROOT/build/node/node_modules/.bin:$PATH"
  node_is_new_enough || fail "Node 20.19 or later could not be installed; put one on the PATH."
}

# Fetches the viewer's npm packages if the lock file has changed since the last call.
install_web() {
  use_node
  local lock="$KERF_ROOT/web/package-lock.json" stamp="$KERF_ROOT/web/node_modules/.kerf-lock"
  if ! cmp -s "$lock" "$stamp"; then
    step "Fetching the web viewer's packages" npm-ci npm --prefix "$KERF_ROOT/web" ci --no-audit --no-fund
    cp "$lock" "$stamp"
  fi
}

# Builds the kernel for pages, for those of a server and for kerf.html, if its packages are
# installed. Otherwise deletes the modules of an older build, which would not match the server's
# kernel.
build_wasm() {
  local missing
  mapfile -t missing < <(packages_missing wasm)
  if [ ${#missing[@]} = 0 ]; then
    build_all wasm -- kerf_page
    build_all wasm-files -- kerf_files
    return
  fi
  rm -f "$KERF_ROOT"/web/public/kerf{,_files}.wasm
  echo "The page gets no copy of the block and shows cuts when the server has made them, and kerf.html can carve nothing," \
    "because kerf.wasm and kerf_files.wasm need Debian packages that are missing: ${missing[*]}. To install them: docker/machine.sh install wasm"
}

build_page() {
  install_web
  step "Building the web viewer" web npm --prefix "$KERF_ROOT/web" run build
}

# build_all PRESET [CMAKE-OPTION...] -- TARGET...: configures and builds. The target `web` is the
# viewer.
build_all() {
  local preset="$1" options=()
  shift
  while [ "$1" != -- ]; do options+=("$1"); shift; done
  shift
  if [ -z "${CMAKE_CXX_COMPILER_LAUNCHER:-}" ] && command -v ccache >/dev/null; then
    export CMAKE_CXX_COMPILER_LAUNCHER=ccache
    export CCACHE_SLOPPINESS="${CCACHE_SLOPPINESS:-pch_defines,time_macros}" # precompiled headers need it
  fi
  cd "$KERF_ROOT" || exit 1
  step "Configuring ($preset)" "configure-$preset" cmake --preset "$preset" "${options[@]}"
  step "Building ($preset); the first time takes minutes" "build-$preset" \
    cmake --build --preset "$preset" --target "$@"
}

# Prints the packages whose shared libraries a program loads, i.e. those that a slim image needs.
libraries_of() {
  # Search by name, not by path: dpkg lists /lib/x where the loader reports /usr/lib/x, a link to
  # it.
  ldd "$1" | awk '$2 == "=>" { print $3 }' | xargs -n 1 realpath | sed 's|.*/|*-linux-gnu/|' |
    xargs dpkg-query -S | cut -d: -f1 | sort -u
}

if [ "${BASH_SOURCE[0]}" = "$0" ]; then
  set -euo pipefail
  case "${1:-}" in
    install) shift; install_sections "$@" ;;
    packages) shift; packages_of "$@" ;;
    web) { [ "${KERF_WASM:-}" = later ] || build_wasm; } && build_page ;;
    wasm) build_wasm ;;
    page) build_page ;;
    libraries) libraries_of "$2" ;;
    *) fail "usage: docker/machine.sh install|packages SECTION... | web | wasm | page | libraries PROGRAM" ;;
  esac
fi
