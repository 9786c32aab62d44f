#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# tidy.sh [FILE...]: runs clang-tidy-19 (.clang-tidy) over the named C++ sources; over every one if none are named, which
# takes long. Configures its own build folder, because clang does not read the precompiled headers of g++.
set -euo pipefail
cd "$(dirname "$0")/../.."
command -v clang-tidy-19 >/dev/null || { echo "skipped: clang-tidy-19 is not installed"; exit 77; }
build=build/tidy
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Debug -DKERF_FAST_BUILD=OFF >/dev/null
if [ $# = 0 ]; then mapfile -t files < <(git ls-files 'kernel/*.cpp' 'server/*.cpp' 'haptic_agent/*.cpp'); else files=("$@"); fi
printf '%s\n' "${files[@]}" | xargs -P "$(nproc)" -n 4 \
  clang-tidy-19 -p "$build" --quiet --warnings-as-errors='*' --extra-arg=-Wno-unknown-warning-option
echo "clang-tidy-19: ${#files[@]} files without a warning"
