// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <source_location>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

namespace kerf::test {

/// Returns the value of an expected or optional outcome. Without a value, ends the test with the
/// place of the call and the error.
template <typename Outcome>
auto value_of(Outcome outcome, std::source_location at = std::source_location::current()) {
  if (outcome.has_value()) return *std::move(outcome);
  std::ostringstream text;
  text << at.file_name() << ':' << at.line() << ": there is no value. ";
  if constexpr (requires { text << outcome.error(); }) {
    text << outcome.error();
  } else if constexpr (requires { text << describe(outcome.error()); }) {
    text << describe(outcome.error());
  } else if constexpr (requires { text << to_string(outcome.error()); }) {
    text << to_string(outcome.error());
  } else if constexpr (requires { text << outcome.error().reason; }) {
    text << outcome.error().reason;
  }
  throw std::runtime_error(text.str());
}

/// Returns the error of an expected outcome. With a value, ends the test with the place of the
/// call.
template <typename Outcome>
  requires requires(Outcome outcome) { outcome.error(); }
auto error_of(Outcome outcome, std::source_location at = std::source_location::current()) {
  if (!outcome.has_value()) return std::move(outcome).error();
  throw std::runtime_error(std::string(at.file_name()) + ':' + std::to_string(at.line()) +
                           ": there is a value instead of an error");
}

}  // namespace kerf::test
