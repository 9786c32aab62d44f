#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# compile.sh COMPILER SOURCE KERF_INCLUDE: compiles the CHAI3D example against CHAI3D itself. The
# environment variable CHAI3D names its folder; without it, and without an installed one, exits with
# 77 (skipped).
set -euo pipefail
found=
for folder in "${CHAI3D:-}" /usr/include/chai3d /usr/local/include/chai3d /opt/chai3d; do
  for root in "$folder/src" "$folder"; do
    [ -n "$folder" ] && [ -f "$root/devices/CGenericHapticDevice.h" ] && found=${found:-$root}
  done
done
[ -n "$found" ] || { echo "CHAI3D is not here"; exit 77; }
"$1" -std=c++14 -fsyntax-only -Wall -Wextra -I "$(dirname "$2")" -I "$3" \
  -isystem "$found" -isystem "$found/../externals/Eigen" -isystem "$found/../externals/glew/include" "$2"
