// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kerf::bench {

/// Prints the errors of the mechanistic law against published recordings of slots: with
/// coefficients that fit the remaining means of a series, and with those of another source.
void print_published_forces();

}  // namespace kerf::bench
