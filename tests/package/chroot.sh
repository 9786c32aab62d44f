#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# chroot.sh [BUILD]: makes the Debian packages from a complete build (default: build/release), installs them with apt in
# a fresh Debian 12 chroot, and uses them there: kerf-server serves its page, kerf-carve carves a program, the examples
# build with find_package and with pkg-config. Needs root, debootstrap and this machine's package sources; takes minutes.
set -euo pipefail
cd "$(dirname "$0")/../.."
build=$(realpath "${1:-build/release}")
[ "$(id -u)" = 0 ] || { echo "skipped: chroot.sh needs root"; exit 77; }
command -v debootstrap >/dev/null || { echo "skipped: debootstrap is not installed"; exit 77; }
# The mirror of this machine: the first source that names bookworm.
# shellcheck disable=SC2016
mirror=$(apt-get indextargets --format '$(REPO_URI) $(RELEASE)' 2>/dev/null | awk '$2 == "bookworm" || $2 == "stable" { print $1; exit }')
[ -n "$mirror" ] || { echo "skipped: no package source of Debian 12 on this machine"; exit 77; }

root=$(mktemp -d "${TMPDIR:-/tmp}/kerf-chroot.XXXXXX")
cleanup() {
  umount "$root/proc" 2>/dev/null || true
  rm -rf --one-file-system "$root"
}
trap cleanup EXIT

echo "making the packages"
mkdir "$root.debs" && trap 'cleanup; rm -rf "$root.debs"' EXIT
cpack --config "$build/CPackConfig.cmake" -B "$root.debs" >"$root.debs/cpack.log" || { cat "$root.debs/cpack.log"; exit 1; }
for deb in "$root.debs"/*.deb; do
  dpkg-deb --field "$deb" Package Version Depends Description | head -4
  dpkg-deb --contents "$deb" | awk '{ print $6 }' >"$deb.files"
done

echo "making the chroot"
debootstrap --variant=minbase bookworm "$root" "$mirror" >"$root.debs/debootstrap.log" || { tail "$root.debs/debootstrap.log"; exit 1; }
mount -t proc proc "$root/proc"
cp /etc/resolv.conf "$root/etc/resolv.conf"
# This machine's access to its package sources: proxy, certificates.
{ grep -ls '^ *Acquire' /etc/apt/apt.conf /etc/apt/apt.conf.d/* || true; } | while read -r file; do cp "$file" "$root$file"; done
mkdir -p "$root/debs" "$root/test"
cp "$root.debs"/*.deb "$root/debs/"
cp -r haptic_agent/examples "$root/test/agent_examples"
cp -r kernel/examples tests/package/*.ngc tests/package/*.json "$root/test/"

cat >"$root/test/run.sh" <<'TXT'
set -eux
export DEBIAN_FRONTEND=noninteractive
apt-get update -q
apt-get install -qy --no-install-recommends /debs/kerf_*.deb /debs/kerf-agent_*.deb
for program in kerf-server kerf-agent kerf-carve kerf-demo; do $program --version; done
kerf-carve --scene /test/pocket.json --program /test/pocket.ngc --stl /test/part.stl --report /test/report.json
test -s /test/part.stl
kerf-demo /test
kerf-server --listen 127.0.0.1:8099 --data /test/data --scene /test/pocket.json &
server=$!
apt-get install -qy --no-install-recommends curl
for i in 1 2 3 4 5 6 7 8 9; do curl -fsS http://127.0.0.1:8099/healthz && break; sleep 1; done
curl -fsS http://127.0.0.1:8099/ | grep -qi '<html'
curl -fsS http://127.0.0.1:8099/v1/sessions | grep -q pocket
kill $server; wait $server
apt-get install -qy --no-install-recommends /debs/libkerf-dev_*.deb /debs/libkerf-agent1_*.deb g++ cmake make
cmake -S /test/examples -B /test/build && cmake --build /test/build
cmake -S /test/agent_examples -B /test/agent_build && cmake --build /test/agent_build
/test/agent_build/press 2>&1 | grep usage
/test/build/carve /test/block.stl
/test/build/verify_nc /test/pocket.json /test/pocket.ngc
g++ $(pkg-config --cflags kerf-formats) /test/examples/carve.cpp -o /test/carve $(pkg-config --libs kerf-formats)
/test/carve
apt-get remove -qy kerf kerf-agent libkerf-dev libkerf-agent1
TXT
echo "installing and running in the chroot"
chroot "$root" sh /test/run.sh >"$root.debs/run.log" 2>&1 || { tail -n 60 "$root.debs/run.log"; exit 1; }
grep -E '^(kerf-[a-z]+ [0-9]|removed )' "$root.debs/run.log"
echo "passed: installed, served, carved, built against and removed in a fresh Debian 12"
