// SPDX-License-Identifier: Apache-2.0
#include "kernel/math/targets.h"

#define KERF_UNIT_TARGET
#define KERF_FOR_UNIT_TARGET KERF_FOR_BASE_TARGET
#include "kernel/sweep/turning_unit.h"
