// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "server/formats/gcode/canon.h"

namespace kerf {

/// What a move is beside its way in the plane.
struct CompensatedInfo {
  GcodeAxes axes{};  ///< the programmed end; only A, B and C are looked at
  GcodeFeed feed;
  double per_move = 0;  ///< G93: moves a minute; the feed follows from the programmed length
  std::array<bool, 6> named{};
  std::size_t file = 0, line = 0;
};

/// A move of the tool's centre, or a dwell between such moves.
struct CompensatedMove {
  enum class Kind { kRapid, kFeed, kArc, kDwell };
  Kind kind = Kind::kFeed;
  PlanePoint end;
  PlanePoint center;   ///< kArc
  int turns = 0;       ///< kArc, as arc_about takes it
  double seconds = 0;  ///< kDwell
  CompensatedInfo info;
  double direction_first = 0, direction_second = 0;  ///< in which it may not be turned back
  double programmed_sweep_rad = 0;                   ///< kArc: of the programmed arc; 0: any
};

/// Cutter radius compensation (G41, G42) as LinuxCNC computes it: the tool's centre keeps its
/// radius beside the programmed path, goes round outside corners on an arc and stops short in
/// inside corners. A move waits until the next one tells the corner at its end. Only in the planes
/// XY and ZX. Throws GcodeFault for what the tool cannot reach without gouging.
class CutterCompensation {
 public:
  using Emit = std::function<void(const CompensatedMove&)>;
  explicit CutterCompensation(Emit emit) : emit_(std::move(emit)) {}

  /// `side` > 0: left of the path. The tool is at `at`, uncompensated.
  void start(int side, double radius_mm, ArcPlane plane);
  /// The program's unit, on which LinuxCNC's tolerances depend.
  void set_unit(double unit_mm) { unit_mm_ = unit_mm; }
  /// Lets the tool go where it is, `at`; returns the programmed point that it is beside, if it is.
  std::optional<PlanePoint> end(PlanePoint at);
  /// Emits what waits; it ends where the tool is, `at`.
  void flush(PlanePoint at);

  bool on() const { return side_ != 0; }
  /// The tool is beside the path: the entry move has been made.
  bool beside() const { return on() && beside_; }
  /// Moves have to go through straight() and arc().
  bool active() const { return on() && radius_ > 0; }
  int side() const { return side_; }
  ArcPlane plane() const { return plane_; }
  /// The programmed point; only while beside().
  PlanePoint programmed() const { return programmed_; }

  /// Each returns where the tool's centre ends. `at` is where it is, as it was returned before.
  PlanePoint straight(bool rapid, PlanePoint at, PlanePoint to, CompensatedInfo info);
  PlanePoint arc(PlanePoint at, PlanePoint to, const ArcCenter& center, bool clockwise, int turns,
                 double spiral_tolerance_mm, CompensatedInfo info);
  void dwell(double seconds, const CompensatedInfo& info);

 private:
  PlanePoint enter_straight(bool rapid, PlanePoint at, PlanePoint to, const CompensatedInfo& info);
  PlanePoint enter_arc(PlanePoint at, PlanePoint to, PlanePoint center, bool clockwise, int turns,
                       double spiral_tolerance_mm, const CompensatedInfo& info);
  PlanePoint follow_straight(bool rapid, PlanePoint at, PlanePoint to, const CompensatedInfo& info);
  PlanePoint follow_arc(PlanePoint at, PlanePoint to, PlanePoint center, int turns,
                        const CompensatedInfo& info);
  PlanePoint inside_corner(PlanePoint at, double theta, double beta) const;
  PlanePoint inside_corner_after_arc(const CompensatedMove& arc, PlanePoint to) const;
  PlanePoint inside_corner_before_arc(PlanePoint center, double radius, double theta, double beta,
                                      int turns) const;
  PlanePoint inside_corner_of_arcs(const CompensatedMove& before, PlanePoint center, double radius,
                                   int turns) const;
  void round_corner(bool rapid, PlanePoint at, PlanePoint to, const CompensatedInfo& info);
  void shorten_to(PlanePoint point);
  void check_shortened(const CompensatedMove& move, PlanePoint point) const;
  void emit_waiting();
  void push(CompensatedMove move);
  bool inside(int turns) const { return (side_ > 0) == (turns > 0); }
  bool waiting_arc() const {
    return !waiting_.empty() && waiting_.front().kind == CompensatedMove::Kind::kArc;
  }
  double quarter() const;

  Emit emit_;
  int side_ = 0;
  double radius_ = 0;
  double unit_mm_ = 1;
  ArcPlane plane_ = ArcPlane::kXy;
  bool beside_ = false;
  PlanePoint programmed_;
  std::vector<CompensatedMove> waiting_;
  std::optional<PlanePoint> waiting_from_;  ///< where what waits begins
};

/// The angle from `from` to `to` about a centre; `turns` as arc_about takes it.
double sweep_rad(PlanePoint from, PlanePoint center, int turns, PlanePoint to);

}  // namespace kerf
