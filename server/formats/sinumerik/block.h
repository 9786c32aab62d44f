// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/formats/sinumerik/values.h"

namespace kerf {

/// A word of a block: an address with a value (X10, CR=5, Z=IC(2), T="MILL"), a keyword (TRAORI) or
/// a call (CYCLE81(…)).
struct SinumerikWord {
  enum class Kind { kKeyword, kValue, kText, kCall };
  enum class How { kModal, kAbsolute, kIncremental };
  std::string name;
  Kind kind = Kind::kKeyword;
  double value = 0;
  How how = How::kModal;  ///< AC, IC
  std::string text = {};  ///< of a call, between its parentheses; of kText, without quotes
  bool used = false;
};

/// Divides a block in capital letters, without comment and number, into words and computes their
/// values. Throws ProgramFault.
std::vector<SinumerikWord> sinumerik_words(std::string_view block, const SinumerikValues& values);

/// Divides the text of a call at its commas. A missing argument is nullopt, a text in quotes 0.
std::vector<std::optional<double>> sinumerik_arguments(std::string_view text,
                                                       const SinumerikValues& values);

}  // namespace kerf
