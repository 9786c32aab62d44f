// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

namespace kerf {

/// What is wrong with a program, and where.
struct ProgramError {
  std::string file;
  std::size_t line = 0;  ///< from 1; 0 where it concerns the whole file
  std::string word;      ///< the offending word as written; empty where no single word is to blame
  std::string reason;    ///< one sentence
};
/// "file:line: reason (at 'word')", one line.
std::string to_string(const ProgramError& error);

}  // namespace kerf
