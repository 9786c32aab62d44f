#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# symbols.sh LIBRARY HEADER: the library exports exactly the functions that the header declares, under one version, and
# needs no library of a device or of the file formats.
set -euo pipefail
library=$1 header=$2
nm -D --defined-only "$library" | awk '$2 != "A" { print $3 }' | sort >"${TMPDIR:-/tmp}/exported.$$"
trap 'rm -f "${TMPDIR:-/tmp}/exported.$$"' EXIT
grep -o 'kerf_agent_[a-z_]*(' "$header" | tr -d '(' | grep -vx kerf_agent_plugin_function | sort -u | sed 's/$/@@KERF_AGENT_1/' |
  diff - "${TMPDIR:-/tmp}/exported.$$"
if readelf -d "$library" | grep NEEDED | grep -E 'usb|meshopt|minizip|CLI'; then exit 1; fi
readelf -d "$library" | grep -q 'SONAME.*libkerf_agent.so.1'
