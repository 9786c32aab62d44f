// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tests/arch/source.h"

namespace kerf::arch {

/// Returns the occurrences of retired words, alone or in identifiers, in code, comments, texts and
/// documents. CONTRIBUTING.md has the glossary of the words to use.
std::vector<Violation> check_words(const Source& source);

}  // namespace kerf::arch
