// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>

#include "server/formats/control/arc.h"
#include "server/formats/gcode/modes.h"

namespace kerf {

/// Sticky words of canned cycles, kept from block to block, in program units and s.
struct CycleMemory {
  int code = 0;  ///< the last cycle, times ten; 0 after another motion
  double r = 0, depth = 0, p = 0, q = 0, i = 0, j = 0, k = 0;
  /// The words that LinuxCNC requires may be missing, and the spindle is not watched (Macro B).
  bool lenient = false;
  /// R and depth are levels from their block on, with G91 too: a change between G90 and G91 does
  /// not move them (Fanuc, Haas). Otherwise each block reads them again.
  bool levels = false;
  std::optional<double> initial_level;  ///< level at which the first of consecutive cycles started
  PlanePoint end = {};                  ///< of the last cycle
};

/// The words of a canned cycle in one block, in program units and s, in the axes of its plane.
struct CycleWords {
  std::optional<double> first, second;        ///< position of the hole
  std::optional<double> depth;                ///< bottom of the hole
  std::optional<double> distance, angle_deg;  ///< position in polar coordinates (@ ^)
  std::optional<double> r, p, q, i, j, k;
  int repeats = 1;  ///< 0 (Macro B): only stores the words
};

/// One step of a canned cycle, mm, in the axes of its plane.
struct CycleStep {
  enum class Kind { kRapid, kFeed, kDwell };
  Kind kind = Kind::kRapid;
  PlanePoint to = {};
  double seconds = 0;  ///< kDwell
};

/// A canned cycle, G73, G74 or G81 to G89, in LinuxCNC's steps. It computes in program units, like
/// LinuxCNC, because the last bit decides whether one more peck reaches the bottom.
class Cycle {
 public:
  /// Starts at `at`, mm. `code` is times ten. Words missing in the block are taken from `memory`,
  /// which is updated and outlives the cycle. Throws ProgramFault for a missing word, an R plane
  /// below the bottom of the hole, or a spindle that is stopped or turns in the wrong direction.
  Cycle(int code, const GcodeModes& modes, PlanePoint at, const CycleWords& words,
        CycleMemory& memory);

  /// Returns the next step, or nullopt at the end. Throws ProgramFault for polar increments at the
  /// origin.
  std::optional<CycleStep> next();
  /// The position after the last step, mm.
  PlanePoint end() const { return in_mm(end_); }

 private:
  void recall();
  void recall_heights(double initial);
  void set_heights(double initial);
  void set_hole();
  void advance_hole();
  void begin_hole();
  void drill();
  void peck();
  void bore_back();
  PlanePoint in_mm(PlanePoint point) const;
  void rapid(PlanePoint to) {
    steps_.push_back({.kind = CycleStep::Kind::kRapid, .to = in_mm(to)});
  }
  void rapid_to(double normal) { rapid({hole_.first, hole_.second, normal}); }
  void feed_to(double normal);
  void dwell();

  int code_;
  GcodeModes modes_;
  CycleWords words_;
  CycleMemory* memory_;
  bool repeated_;
  PlanePoint hole_, end_;
  double r_ = 0, bottom_ = 0, middle_ = 0, clear_ = 0;
  double level_ = 0;             ///< before the first hole
  int holes_ = 0;                ///< begun
  std::optional<double> peck_;   ///< depth of the next peck, while the hole is pecked
  std::deque<CycleStep> steps_;  ///< of the current hole or peck, not yet returned
};

}  // namespace kerf
