// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace CLI {
class Validator;
}

namespace kerf::agent {

enum class Numbers { kAny, kWhole };

/// Returns a check for the number of an option, which must be finite and from `least` to `most`.
/// Unlike CLI::Range it rejects NaN. The help shows the range, unless `most` is 1e5 or more.
CLI::Validator number_in(double least, double most, Numbers numbers = Numbers::kAny);

}  // namespace kerf::agent
