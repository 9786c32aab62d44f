#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# install.sh BUILD SOURCE: installs a build into an empty prefix and checks it as an embedder would:
# every public header compiles alone, the examples build with find_package and with pkg-config, and
# the installed programs and devices run.
set -euo pipefail
build=$1 source=$2
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
prefix=$scratch/prefix
cmake --install "$build" --prefix "$prefix" >"$scratch/install.log" || { cat "$scratch/install.log"; exit 1; }
lib=$(dirname "$(find "$prefix" -name libkerf_kernel.a)")

echo "programs"
version=$(sed -n 's/.*kVersion\[\] = "\(.*\)".*/\1/p' "$prefix/include/kerf/version.h")
for program in kerf-server kerf-agent kerf-carve kerf-demo; do
  "$prefix/bin/$program" --version | grep -q "^$program $version" || { echo "$program --version"; exit 1; }
  test -s "$prefix/share/man/man1/$program.1"
  bash -n "$prefix/share/bash-completion/completions/$program"
done
grep -q '\-\-listen' "$prefix/share/bash-completion/completions/kerf-server"
grep -q "ExecStart=$prefix/bin/kerf-server" "$prefix/lib/systemd/system/kerf-server.service"
test -f "$prefix/lib/udev/rules.d/70-kerf.rules"
if command -v systemd-analyze >/dev/null; then
  systemd-analyze verify --man=no "$prefix/lib/systemd/system/kerf-server.service"
fi

echo "headers"
(cd "$prefix/include" && find kerf -name '*.h') >"$scratch/headers"
test "$(wc -l <"$scratch/headers")" -gt 40
flags=$(PKG_CONFIG_PATH=$lib/pkgconfig pkg-config --cflags kerf-formats)
export flags
# shellcheck disable=SC2016
xargs -P "$(nproc)" -I{} sh -c \
  'echo "#include <{}>" | g++ $flags -Wall -Wextra -Werror -fsyntax-only -x c++ - || { echo "{} does not compile alone"; exit 255; }' \
  <"$scratch/headers"

echo "examples with find_package"
cmake -S "$source/kernel/examples" -B "$scratch/examples" -G Ninja -DCMAKE_PREFIX_PATH="$prefix" >"$scratch/cmake.log" ||
  { cat "$scratch/cmake.log"; exit 1; }
cmake --build "$scratch/examples"
# Kerf's own warning options must not reach users of the library.
if grep -q Wconversion "$scratch/examples/build.ninja"; then echo "warning options leak"; exit 1; fi

echo "examples with pkg-config"
export PKG_CONFIG_PATH=$lib/pkgconfig
for name in carve force verify_nc; do
  # shellcheck disable=SC2046
  g++ $(pkg-config --cflags kerf-formats) "$source/kernel/examples/$name.cpp" -o "$scratch/$name" \
    $(pkg-config --libs kerf-formats)
done

echo "agent examples"
cmake -S "$source/haptic_agent/examples" -B "$scratch/agent" -G Ninja -DCMAKE_PREFIX_PATH="$prefix" >"$scratch/cmake.log" ||
  { cat "$scratch/cmake.log"; exit 1; }
cmake --build "$scratch/agent"
# shellcheck disable=SC2046
gcc -std=c11 -Wall -Wextra -Wpedantic -Werror $(pkg-config --cflags kerf-agent) \
  "$source/haptic_agent/examples/press.c" -o "$scratch/press" $(pkg-config --libs kerf-agent) -lm
mkdir "$scratch/data"
sed 's/"pocket"/"second"/' "$source/tests/package/pocket.json" >"$scratch/second.json"
"$prefix/bin/kerf-server" --listen 127.0.0.1:0 --data "$scratch/data" --scene "$source/tests/package/pocket.json" \
  --scene "$scratch/second.json" >"$scratch/address" &
server=$!
trap 'kill $server; rm -rf "$scratch"' EXIT
until grep -q '^http' "$scratch/address"; do sleep 0.05; done
LD_LIBRARY_PATH=$lib "$scratch/press" "$(head -1 "$scratch/address")" pocket
LD_LIBRARY_PATH=$lib python3 "$source/haptic_agent/examples/press.py" "$(head -1 "$scratch/address")" second

echo "runs"
for folder in "$scratch/examples" "$scratch"; do
  "$folder/carve" "$scratch/part.stl" | tee "$scratch/out"
  grep -q '^removed 1632' "$scratch/out" # exact: 1631.4 mm3
  "$folder/force"
  "$folder/verify_nc" "$source/tests/package/pocket.json" "$source/tests/package/pocket.ngc"
  if "$folder/verify_nc" "$source/tests/package/pocket.json" "$source/tests/package/crash.ngc"; then
    echo "verify_nc accepts a rapid motion through material"
    exit 1
  fi
done
