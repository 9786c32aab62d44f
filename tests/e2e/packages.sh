#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs the npm packages of the end-to-end tests, unless those of this lock file are installed already.
set -euo pipefail
cd "$(dirname "$0")"
stamp=node_modules/.kerf-lock
if cmp -s package-lock.json "$stamp"; then exit 0; fi
npm ci --prefer-offline --no-audit --no-fund
cp package-lock.json "$stamp"
