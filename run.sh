#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# From a fresh clone on Debian 12 to a running demo: installs missing packages, builds, starts the server and two simulated
# hands that carve an ammonite, and prints the address to open. See README.md.
set -euo pipefail
cd "$(dirname "$0")"
# shellcheck source=docker/machine.sh
. docker/machine.sh

PORT=8080
LISTEN=127.0.0.1
DATA=
DEMO=true
BUILD_ONLY=false
SESSION=ammonite # the server names a session after its scene
CHILDREN=()
SERVER=
WASM= # pid of the build of the kernel for pages, in the background
SCRATCH=

usage() {
  cat <<'TXT'
usage: ./run.sh [--port N] [--listen ADDR] [--data DIR] [--no-demo] [--build-only]
  --port N       port to serve on (default 8080; the next free one if it is taken)
  --listen ADDR  address to serve on (default 127.0.0.1). 0.0.0.0 also serves the network, where people watch and carve
                 as guests (kerf-server --open), unless KERF_ADMIN_TOKEN is set: then they need an invitation
  --data DIR     folder of the sessions. Default: with the demo a temporary folder, removed at the end;
                 with --no-demo ~/.local/share/kerf
  --no-demo      start the server only
  --build-only   install, build everything (libkerf_agent too), start nothing
Ctrl-C ends all programs that this script started.
TXT
}

parse_options() {
  while [ $# -gt 0 ]; do
    case "$1" in
      --port) PORT="${2:?--port needs a number}"; shift 2 ;;
      --listen) LISTEN="${2:?--listen needs an address}"; shift 2 ;;
      --data) DATA="${2:?--data needs a folder}"; shift 2 ;;
      --no-demo) DEMO=false; shift ;;
      --build-only) BUILD_ONLY=true; shift ;;
      -h|--help) usage; exit 0 ;;
      *) usage >&2; fail "Unknown option: $1" ;;
    esac
  done
  if ! [[ $PORT =~ ^[0-9]{1,5}$ ]] || ((PORT < 1 || PORT > 65535)); then fail "Not a port: $PORT"; fi
}

build() {
  local tests=ON programs=(kerf-server kerf-carve)
  if [ -n "$(packages_missing test)" ]; then tests=OFF; fi # only test.sh installs test packages
  install_sections build run
  (install_sections wasm) || true # the page works without it; build_wasm names the missing packages
  use_node
  if $DEMO || $BUILD_ONLY; then programs+=(kerf-agent kerf-demo); fi
  if $BUILD_ONLY; then programs+=(kerf_agent); fi
  if ! $BUILD_ONLY && is_wasm_new; then export KERF_WASM=later; fi
  build_all release -DKERF_TESTS=$tests -- web "${programs[@]}"
}

# Whether the kernel for pages can be built but never was. That takes minutes, during which the page
# works without it. A kernel from an older build must be updated before the page is served, because
# it may not match the server's.
is_wasm_new() {
  [ -z "$(packages_missing wasm)" ] && ! compgen -G 'web/public/*.wasm' >/dev/null
}

program() { echo "$KERF_ROOT/build/release/bin/$1"; }

is_taken() { (exec 3<>"/dev/tcp/127.0.0.1/$1") 2>/dev/null; }

find_port() {
  local first=$PORT
  while is_taken "$PORT"; do
    PORT=$((PORT + 1))
    if ((PORT > first + 50 || PORT > 65535)); then fail "No free port from $first to $PORT; choose one with --port."; fi
  done
  if [ "$PORT" != "$first" ]; then echo "Port $first is taken; using $PORT."; fi
}

# Ends the started programs with SIGTERM, after 5 s with SIGKILL. Runs at every exit of this script.
stop_children() {
  trap - EXIT
  trap '' INT TERM # a second Ctrl-C must not leave programs behind
  local child
  for child in "${CHILDREN[@]}"; do kill -TERM "$child" 2>/dev/null || true; done
  if [ -n "$WASM" ]; then kill -TERM -- "-$WASM" 2>/dev/null || true; fi # with its compilers
  for _ in {1..50}; do
    [ -n "$(jobs -rp)" ] || break
    sleep 0.1
  done
  for child in $(jobs -rp); do kill -KILL "$child" 2>/dev/null || true; done
  wait 2>/dev/null || true
  if [ -n "$SCRATCH" ]; then rm -rf "$SCRATCH"; fi
}

# start NAME COMMAND...: starts a program in the background, with its output in a log.
start() {
  local log="$KERF_LOGS/$1.log"
  shift
  "$@" >"$log" 2>&1 </dev/null &
  CHILDREN+=($!)
}

server_failed() {
  tail -n 20 "$KERF_LOGS/kerf-server.log" >&2
  fail "$1 Its whole log: $KERF_LOGS/kerf-server.log"
}

start_server() {
  local options=(--listen "$LISTEN:$PORT" --data "$DATA" --web web/dist)
  case "$LISTEN" in
    127.*|::1|'[::1]') ;;
    *) if [ -z "${KERF_ADMIN_TOKEN:-}" ]; then options+=(--open); fi ;;
  esac
  if $DEMO; then options+=(--scene haptic_agent/demo/demo.json); fi
  start kerf-server "$(program kerf-server)" "${options[@]}"
  SERVER=$!
  for _ in {1..150}; do
    if curl -fsS -o /dev/null "http://$(local_address)/healthz" 2>/dev/null; then return; fi
    kill -0 "$SERVER" 2>/dev/null || server_failed "The server exited at its start."
    sleep 0.1
  done
  server_failed "The server did not answer /healthz within 15 s."
}

# Prints the address under which this machine reaches the server.
local_address() {
  case "$LISTEN" in 0.0.0.0|::|'[::]') echo "127.0.0.1:$PORT" ;; *) echo "$LISTEN:$PORT" ;; esac
}

start_hand() {
  start "kerf-agent-$1" "$(program kerf-agent)" --server "http://$(local_address)" --session "$SESSION" \
    --name "$2" --color "$3" --device "sim:$SCRATCH/$1.apt" --stiffness 10
}

start_wasm() {
  # A process group of its own, so that all of it can be ended.
  start wasm setsid nice docker/machine.sh wasm
  WASM=$!
}

# Copies the modules to the page that is being served.
serve_wasm() {
  local module
  for module in web/public/*.wasm; do
    cp "$module" web/dist/.module && mv web/dist/.module "web/dist/${module##*/}"
  done
}

start_demo() {
  start_hand first Ada '#d9541e'
  start_hand second Grace '#1e7ad9'
}

# Waits until the server ends or Ctrl-C is pressed. Reports a failed hand and the end of the
# kernel's build.
watch_over() {
  local ended rc hands=$((${#CHILDREN[@]} - 1))
  if [ "${KERF_WASM:-}" = later ]; then start_wasm; fi
  while [ ${#CHILDREN[@]} -gt 0 ]; do
    rc=0
    wait -n -p ended || rc=$?
    if [ "${ended:-}" = "$SERVER" ]; then server_failed "The server ended (exit $rc)."; fi
    if [ "${ended:-}" = "$WASM" ]; then
      if [ $rc = 0 ] && serve_wasm; then
        echo "The kernel for pages is built: reload the page, and it shows cuts at once. kerf.html carves now."
      else
        echo "The kernel for pages could not be built (exit $rc; log: $KERF_LOGS/wasm.log). The page works without it." >&2
      fi
      WASM=
      continue
    fi
    if [ $rc != 0 ]; then
      tail -n 5 "$KERF_LOGS"/kerf-agent-*.log >&2
      echo "A simulated hand ended (exit $rc); its log is in $KERF_LOGS. The server continues." >&2
    fi
    hands=$((hands - 1))
    if [ $hands = 0 ]; then echo "The simulated hands have finished; the server runs until Ctrl-C."; fi
  done
}

main() {
  parse_options "$@"
  build
  if $BUILD_ONLY; then return; fi
  SCRATCH="$(mktemp -d)"
  trap stop_children EXIT
  trap 'echo; exit 130' INT
  trap 'exit 143' TERM
  if [ -z "$DATA" ]; then
    if $DEMO; then DATA="$SCRATCH/data"; else DATA="${XDG_DATA_HOME:-$HOME/.local/share}/kerf"; fi
  fi
  mkdir -p "$DATA" "$KERF_LOGS"
  export KERF_TOKEN="${KERF_TOKEN:-${KERF_ADMIN_TOKEN:-}}" # for the simulated hands
  if $DEMO; then step "Computing the tool paths of the demo" kerf-demo "$(program kerf-demo)" "$SCRATCH"; fi
  find_port
  start_server
  if $DEMO; then start_demo; fi
  say "Kerf serves at http://$(local_address)/$($DEMO && echo "?session=$SESSION")    (Ctrl-C ends it)"
  watch_over
}

main "$@"
