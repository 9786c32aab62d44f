// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <expected>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "kernel/sweep/tool_motion.h"
#include "kernel/tool/tool.h"
#include "server/history/record_source.h"
#include "server/history/stroke_table.h"

namespace kerf {

/// A motion of a journal. `tool` is the tool as defined at that time, null for a record that is not
/// a motion.
struct RecordedMotion {
  const Tool* tool = nullptr;
  StrokeId stroke = 0;
  ToolMotion motion;
};

/// Whether a motion starts at the end of the previous one, with the same tool; false if that is
/// null.
inline bool continues(const RecordedMotion* before, const RecordedMotion& motion) {
  return before != nullptr && before->tool == motion.tool &&
         before->motion.to == motion.motion.from;
}

/// The motions of a journal by record, read in windows, the newest of which are kept. Not
/// thread-safe.
class RecordedMotions {
 public:
  /// Records of a window.
  static constexpr std::uint64_t kWindow = 1024;
  struct Window {
    std::uint64_t first = 0;  ///< record
    std::vector<RecordedMotion> motions;
  };

  /// Keeps so many windows, 140 kB each.
  RecordedMotions(std::unique_ptr<RecordSource> journal, std::size_t windows)
      : journal_(std::move(journal)), windows_kept_(windows) {}

  /// Reads the records added since the last call, and calls `visit` with each motion. The error
  /// names the first bad record.
  std::expected<void, std::string> catch_up(
      const std::function<void(std::uint64_t record, const RecordedMotion& motion)>& visit,
      const std::stop_token& stop);
  using Windows = std::vector<std::shared_ptr<const Window>>;
  /// Returns the windows with these first records, which ascend and have been read.
  std::expected<Windows, std::string> windows(std::span<const std::uint64_t> firsts,
                                              const std::stop_token& stop);
  const StrokeTable& strokes() const { return strokes_; }
  /// Number of the first record of the window with `record`.
  static std::uint64_t window_begin(std::uint64_t record) {
    return (record - 1) / kWindow * kWindow + 1;
  }

  /// The newest definition of each tool in the records read.
  std::map<ToolId, Tool> tools() const;

 private:
  struct DefinedTool {
    std::uint64_t record;
    ToolId id;
    Tool tool;
  };

  RecordedMotion motion_of(const JournalRecord& record) const;
  std::expected<void, std::string> read_windows(std::span<const std::uint64_t> firsts,
                                                Windows& windows, const std::stop_token& stop);
  void keep(std::shared_ptr<const Window> window);

  std::unique_ptr<RecordSource> journal_;
  std::size_t windows_kept_;
  StrokeTable strokes_;
  std::deque<DefinedTool> tools_;  ///< by record; they stay where they are
  std::map<std::uint64_t, std::shared_ptr<const Window>> windows_;  ///< by first record
  std::deque<std::uint64_t> newest_;                                ///< windows_, newest last
};

}  // namespace kerf
