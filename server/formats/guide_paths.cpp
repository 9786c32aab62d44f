// SPDX-License-Identifier: Apache-2.0
#include "server/formats/guide_paths.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "server/formats/number_text.h"
#include "server/formats/program_decimator.h"
#include "server/formats/scene.h"

namespace kerf {
namespace {

GuidePose guide_pose(const ToolPose& pose) { return {.tip_mm = pose.tip_mm, .axis = pose.axis}; }

/// Collects the cutting motions of a program as paths.
class PathWriter final : public ProgramWriter {
 public:
  explicit PathWriter(std::vector<GuidePath>& paths) : paths_(paths) {}

  void note(const std::string& /*line*/) override {}
  WriteResult add(const ProgramMotion& motion) override {
    if (motion.rapid) {
      tool_ = 0;
      return {};
    }
    if (tool_ != motion.tool || !(motion.from == end_)) paths_.push_back({guide_pose(motion.from)});
    paths_.back().push_back(guide_pose(motion.to));
    tool_ = motion.tool;
    end_ = motion.to;
    return {};
  }
  WriteResult remark(const MachineRemark& /*said*/) override { return {}; }
  WriteResult finish() override { return {}; }

 private:
  std::vector<GuidePath>& paths_;
  ToolId tool_ = 0;  ///< 0: the next motion begins a path
  ToolPose end_{};
};

/// The columns read from a forces file.
constexpr std::array<std::string_view, 13> kColumns = {
    "x",    "y",    "z",      "i",      "j",      "k",          "fx_n",
    "fy_n", "fz_n", "tx_nmm", "ty_nmm", "tz_nmm", "removed_mm3"};

std::vector<std::string_view> fields_of(std::string_view line) {
  std::vector<std::string_view> fields;
  while (true) {
    const std::size_t comma = line.find(',');
    fields.push_back(line.substr(0, comma));
    if (comma == std::string_view::npos) return fields;
    line.remove_prefix(comma + 1);
  }
}

/// A row of a forces file.
struct ForcesRow {
  GuidePose pose;
  bool cuts = false;
};

/// Reads the rows of a forces file by the names in its header.
class ForcesTable {
 public:
  /// Returns the missing column, or an empty text.
  std::string_view take_header(std::string_view line) {
    const auto names = fields_of(line);
    width_ = names.size();
    for (std::size_t i = 0; i < kColumns.size(); ++i) {
      const auto found = std::ranges::find(names, kColumns[i]);
      if (found == names.end()) return kColumns[i];
      columns_[i] = static_cast<std::size_t>(found - names.begin());
    }
    return {};
  }
  std::optional<ForcesRow> read(std::string_view line) const {
    const auto fields = fields_of(line);
    if (fields.size() != width_) return std::nullopt;
    std::array<double, kColumns.size()> v{};
    for (std::size_t i = 0; i < v.size(); ++i) {
      const std::string_view text = fields[columns_[i]];
      const auto [stop, failed] = number_of_chars(text.data(), text.data() + text.size(), v[i]);
      if (failed != std::errc{} || stop != text.data() + text.size() || !std::isfinite(v[i]))
        return std::nullopt;
    }
    const Vec3 axis{v[3], v[4], v[5]};
    if (!(length(axis) > kGuideAxisMin && length(axis) <= kGuideAxisMax)) return std::nullopt;
    return ForcesRow{.pose = {.tip_mm = {v[0], v[1], v[2]},
                              .axis = normalized(axis),
                              .felt = {{v[6], v[7], v[8]}, {v[9], v[10], v[11]}}},
                     .cuts = v[12] > 0};
  }

 private:
  std::array<std::size_t, kColumns.size()> columns_{};
  std::size_t width_ = 0;
};

/// Divides rows into strokes.
class StrokeCollector {
 public:
  explicit StrokeCollector(double apart_mm) : apart_mm_(apart_mm) {}

  void add(const ForcesRow& row) {
    if (!row.cuts) {
      end();
    } else if (!open_) {
      open_ = true;
      // The stroke begins at the start of its first row's motion.
      strokes_.push_back({before_.value_or(row.pose)});
      strokes_.back().back().felt = row.pose.felt;
      strokes_.back().push_back(row.pose);
    } else if (length(row.pose.tip_mm - strokes_.back().back().tip_mm) >= apart_mm_) {
      strokes_.back().push_back(row.pose);
      last_.reset();
    } else {
      last_ = row.pose;
    }
    before_ = row.pose;
  }
  std::vector<GuidePath> finish() {
    end();
    return std::move(strokes_);
  }

 private:
  void end() {
    if (open_ && last_) strokes_.back().push_back(*last_);
    last_.reset();
    open_ = false;
  }

  double apart_mm_;
  std::vector<GuidePath> strokes_;
  std::optional<GuidePose> before_, last_;
  bool open_ = false;
};

}  // namespace

std::expected<std::vector<GuidePath>, std::string> paths_of_program(const std::string& name,
                                                                    std::string_view text,
                                                                    const Scene& scene,
                                                                    double join_mm) {
  const auto program = parse_program(name, text, scene);
  if (!program) return std::unexpected(to_string(program.error()));
  std::vector<GuidePath> paths;
  ProgramDecimator decimator(std::make_unique<PathWriter>(paths), scene, join_mm);
  for (const ProgramMotion& motion : program->motions) {
    if (auto added = decimator.add(motion); !added) return std::unexpected(added.error());
  }
  if (auto finished = decimator.finish(); !finished) return std::unexpected(finished.error());
  if (paths.empty()) return std::unexpected("has no cutting motion");
  return paths;
}

std::expected<std::vector<GuidePath>, std::string> strokes_of_forces(std::string_view text,
                                                                     double apart_mm) {
  ForcesTable table;
  StrokeCollector strokes(apart_mm);
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (number == 1) {
      const std::string_view missing = table.take_header(line);
      if (missing.empty()) continue;
      return std::unexpected("has no column \"" + std::string(missing) + "\"");
    }
    if (line.empty()) continue;
    const auto row = table.read(line);
    if (!row)
      return std::unexpected("line " + std::to_string(number) +
                             " is not a row of numbers in range");
    strokes.add(*row);
  }
  auto paths = strokes.finish();
  if (paths.empty()) return std::unexpected("has no row that removes material");
  return paths;
}

}  // namespace kerf
