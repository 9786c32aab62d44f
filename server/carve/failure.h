// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <string>
#include <utility>

namespace kerf {

/// Exit statuses of kerf-carve, except those after a signal.
inline constexpr int kBadInput = 2;
inline constexpr int kBadOutput = 1;
/// The program does not make the part, or not safely (verdict.h).
inline constexpr int kFailedVerification = 3;

/// An unfinished command: its exit status and the line to print.
struct Failure {
  int status;
  std::string line;
};

inline std::unexpected<Failure> bad_input(std::string line) {
  return std::unexpected(Failure{kBadInput, std::move(line)});
}
inline std::unexpected<Failure> bad_output(std::string line) {
  return std::unexpected(Failure{kBadOutput, std::move(line)});
}

}  // namespace kerf
