// SPDX-License-Identifier: Apache-2.0
// What the reader of scenes needs for scenes of files, but not for the block of a welcome: that
// names no file, states its accuracy, and has no guides, which belong to devices. Numbers in texts
// need std::from_chars of doubles, which the C++ library for WASI does not have.

#include "server/formats/accuracy_choice.h"
#include "server/formats/guide_paths.h"
#include "server/formats/guide_reader.h"
#include "server/formats/number_text.h"
#include "server/formats/text_file.h"

namespace kerf {

std::optional<std::string> read_file(const std::filesystem::path&) { return std::nullopt; }

std::expected<AccuracyChoice, AccuracyError> choose_accuracy(const AccuracyRequest&,
                                                             const AccuracyUse&) {
  return std::unexpected(AccuracyError{});
}

std::string significant_text(double value, int) { return std::to_string(value); }

std::vector<Guide> read_guides(const SceneValue&, const GuideFile&) { return {}; }

std::expected<std::vector<GuidePath>, std::string> paths_of_program(const std::string&,
                                                                    std::string_view, const Scene&,
                                                                    double) {
  return std::unexpected("");
}

std::expected<std::vector<GuidePath>, std::string> strokes_of_forces(std::string_view, double) {
  return std::unexpected("");
}

}  // namespace kerf
