#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# tidy.sh [FILE...]: runs clang-tidy-19 (.clang-tidy) over the named C++ sources; over every one if none are named, which
# takes long. Configures a build folder of its own, with clang, whose options and headers clang-tidy reads.
set -euo pipefail
cd "$(dirname "$0")/../.."
command -v clang-tidy-19 >/dev/null || { echo "skipped: clang-tidy-19 is not installed"; exit 77; }
build=build/tidy
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_COMPILER=clang++-19 >/dev/null
if [ $# = 0 ]; then mapfile -t files < <(git ls-files '*.cpp'); else files=("$@"); fi
printf '%s\n' "${files[@]}" | xargs -P "$(nproc)" -n 1 clang-tidy-19 -p "$build" --quiet --warnings-as-errors='*'
echo "clang-tidy-19: ${#files[@]} files without a warning"
