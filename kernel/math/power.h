// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kerf {

/// Returns base^exponent for a normal base > 0, with a relative error below 1e-14 where
/// |exponent · ln base| < 30. Uses + − × ÷ only, as sin_cos does.
double power(double base, double exponent);

}  // namespace kerf
