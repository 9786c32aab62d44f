#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# run.sh [SCRATCH]: builds both images from a clean export of HEAD, as a container engine would, on a Debian 12 made by
# debootstrap, and runs them: the server with a read-only root, another port and a health check; a hand that carves in
# it; a volume of another user, which it refuses. A long check: it compiles the programs. Needs root, buildah,
# debootstrap and this machine's package sources. Nothing but SCRATCH (default: a temporary folder) is written.
set -euo pipefail
cd "$(dirname "$0")/../.."
[ "$(id -u)" = 0 ] || { echo "skipped: run.sh needs root"; exit 77; }
for tool in buildah debootstrap curl; do
  command -v $tool >/dev/null || { echo "skipped: $tool is not installed"; exit 77; }
done
# The mirror of this machine: the first source that names bookworm.
# shellcheck disable=SC2016
mirror=$(apt-get indextargets --format '$(REPO_URI) $(RELEASE)' 2>/dev/null | awk '$2 == "bookworm" || $2 == "stable" { print $1; exit }')
[ -n "$mirror" ] || { echo "skipped: no package source of Debian 12 on this machine"; exit 77; }

scratch=${1:-$(mktemp -d "${TMPDIR:-/tmp}/kerf-containers.XXXXXX")}
mkdir -p "$scratch"
scratch=$(realpath "$scratch")
export BUILDAH_ISOLATION=chroot STORAGE_DRIVER=vfs
images() { buildah --root "$scratch/storage" --runroot "$scratch/run" "$@"; }
say() { printf '== %s\n' "$*"; }
fail() { printf 'FAILED: %s\n' "$*" >&2; exit 1; }
# Containers that run in the background, each with a process group of its own: buildah does not pass a signal on.
children=()
set -m
cleanup() {
  local child
  for child in "${children[@]}"; do kill -- "-$child" 2>/dev/null || true; done
  wait 2>/dev/null || true
  if [ $# -gt 0 ]; then rm -rf --one-file-system "$1"; fi
}
# shellcheck disable=SC2064
trap "cleanup $([ $# -gt 0 ] || printf '%q' "$scratch")" EXIT

# What a registry would serve as debian:12-slim, with how this machine reaches its sources: proxy, certificates.
make_base() {
  local root="$scratch/debian" from
  if images inspect --type image docker.io/library/debian:12-slim >/dev/null 2>&1; then return; fi
  debootstrap --variant=minbase bookworm "$root" "$mirror" >"$scratch/debootstrap.log" ||
    { tail "$scratch/debootstrap.log"; fail "debootstrap"; }
  { grep -ls '^ *Acquire' /etc/apt/apt.conf /etc/apt/apt.conf.d/* || true; } | while read -r file; do cp "$file" "$root$file"; done
  cp /etc/ssl/certs/ca-certificates.crt "$root/etc/machine-certificates.pem"
  from=$(images from scratch)
  images copy -q "$from" "$root" / >/dev/null
  images config --cmd /bin/bash --env NODE_EXTRA_CA_CERTS=/etc/machine-certificates.pem "$from"
  images commit -q "$from" docker.io/library/debian:12-slim >/dev/null
  images rm "$from" >/dev/null
  rm -rf --one-file-system "$root"
}

build() {
  images bud --layers --pull-never -q -f docker/kerf.Dockerfile --target "$1" -t "kerf-$1" "$scratch/context" \
    >"$scratch/build-$1.log" 2>&1 || { tail -n 40 "$scratch/build-$1.log"; fail "the image kerf-$1 was not built"; }
  echo "kerf-$1 $(label "kerf-$1" version): $(images images --format '{{.Size}}' "kerf-$1")"
}

# label IMAGE NAME: prints a label of an image.
label() {
  images inspect --type image --format "{{index .OCIv1.Config.Labels \"org.opencontainers.image.$2\"}}" "$1"
}

# in_image IMAGE OPTION... -- COMMAND...: runs a command in a new container of an image, as its user.
in_image() {
  local image=$1 options=()
  shift
  while [ "$1" != -- ]; do options+=("$1"); shift; done
  shift
  images run --isolation chroot "${options[@]}" "$(images from --pull-never "$image")" -- "$@"
}

# until_answers URL: waits until a server answers.
until_answers() {
  for _ in {1..100}; do
    if curl -fsS "$1" >/dev/null 2>&1; then return; fi
    sleep 0.2
  done
  fail "$1 does not answer after 20 s"
}

say "making the base"
make_base
mkdir -p "$scratch/context"
git archive HEAD | tar -x -C "$scratch/context"
say "building"
build server
build agent
in_image kerf-server -- kerf-server --version | grep -q "^kerf-server $(label kerf-server version) " ||
  fail "the image's version is not the program's"
say "built again, nothing is compiled"
first=$(images images -q --no-trunc kerf-server)
build server >/dev/null
[ "$(images images -q --no-trunc kerf-server)" = "$first" ] || fail "a second build gave another image: its layers are not reused"

say "the server, on the port of KERF_LISTEN, with the demo's scene"
install -d -o 10001 -g 10001 "$scratch/blocks"
port=18$((RANDOM % 900 + 100))
in_image kerf-server --volume "$scratch/blocks:/var/lib/kerf" --env KERF_LISTEN=127.0.0.1:$port \
  -- kerf-server --scene /usr/share/kerf/demo/demo.json --open >"$scratch/server.log" 2>&1 &
children+=($!)
until_answers "http://127.0.0.1:$port/healthz"
curl -fsS "http://127.0.0.1:$port/" | grep -qi '<html' || fail "the page is missing"
# shellcheck disable=SC2016
in_image kerf-server --env KERF_LISTEN=127.0.0.1:$port -- sh -c 'curl -fsS "http://127.0.0.1:${KERF_LISTEN##*:}/healthz"' ||
  fail "the health check"
stat -c %u "$scratch"/blocks/*.kerf | grep -qx 10001 || fail "the journal does not belong to uid 10001"

say "a hand carves in it"
removed() { curl -fsS "http://127.0.0.1:$port/v1/sessions/ammonite" | grep -o '"removed_volume_mm3":[^,}]*'; }
before=$(removed)
in_image kerf-agent -- kerf-agent --server "http://127.0.0.1:$port" --session ammonite --name Ada \
  --device sim:/usr/share/kerf/demo/first.apt --stiffness 10 >"$scratch/agent.log" 2>&1 &
children+=($!)
for _ in {1..300}; do
  after=$(removed)
  if [ "$before" != "$after" ]; then break; fi
  sleep 0.2
done
echo "$before, then $after"
[ "$before" != "$after" ] || { tail "$scratch/agent.log"; fail "the hand carved nothing"; }

say "a volume of another user"
install -d -o 0 -g 0 -m 755 "$scratch/foreign"
if in_image kerf-server --volume "$scratch/foreign:/var/lib/kerf" -- kerf-server --listen 127.0.0.1:0 --open >"$scratch/foreign.log" 2>&1; then
  fail "the server accepted a folder that it cannot write to"
fi
cat "$scratch/foreign.log"
grep -q 'uid 10001 cannot write to the data folder /var/lib/kerf, which belongs to uid 0' "$scratch/foreign.log" || fail "its error"
say "passed"
