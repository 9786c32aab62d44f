// SPDX-License-Identifier: Apache-2.0
#include "server/formats/control/line_reader.h"

#include <utility>

#include "server/formats/control/compensation.h"

namespace kerf {
namespace {

/// Pieces of a path per step.
constexpr int kPiecesPerStep = 64;

}  // namespace

std::expected<bool, ProgramError> LineReader::step() {
  if (sink_.waits()) {
    if (auto error = follow_path()) return std::unexpected(*std::move(error));
  } else if (auto error = run()) {
    return std::unexpected(*std::move(error));
  }
  if (runs_ || sink_.waits()) return true;
  try {
    finish();
  } catch (const ProgramFault& fault) {
    return std::unexpected(error_of(fault));
  }
  return false;
}

// Pending motions precede a fault, and may be invalid too.
std::optional<ProgramError> LineReader::run() {
  try {
    runs_ = execute();
  } catch (const ProgramFault& fault) {
    while (sink_.waits()) {
      if (auto earlier = follow_path()) return earlier;
      program_.motions.clear();
    }
    return error_of(fault);
  }
  return std::nullopt;
}

std::optional<ProgramError> LineReader::follow_path() {
  const MotionSink::Place place = sink_.place_of_waiting();
  const auto followed = sink_.go_on(kPiecesPerStep);
  return followed ? std::nullopt : std::optional(error_at(place, followed.error()));
}

void LineReader::warn(const std::string& warning) {
  if (program_.warnings.size() < kProgramWarningsMax) program_.warnings.push_back(warning);
}

void LineReader::warn_once(const std::string& text, std::size_t line) {
  if (program_.warnings.size() >= kProgramWarningsMax || !warned_.insert(text).second) return;
  warn(program_.name + ":" + std::to_string(line) + ": " + text);
}

std::expected<ReadProgram, ProgramError> read_or_assume_wear(
    const std::function<std::expected<ReadProgram, ProgramError>(const std::string&)>& read,
    const std::string& name, const std::string& wear) {
  auto first = read({});
  if (first || !is_compensation_fault(first.error().reason)) return first;
  auto again = read(name + ":" + std::to_string(first.error().line) + ": " + wear +
                    ", as for a path of the tool's center: the tool's radius is not possible here");
  return again || again.error().line > first.error().line ? std::move(again) : std::move(first);
}

}  // namespace kerf
