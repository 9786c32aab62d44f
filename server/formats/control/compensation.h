// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "server/formats/control/canon.h"

namespace kerf {

/// Properties of a move other than its path in the plane.
struct CompensatedInfo {
  GcodeAxes axes{};  ///< programmed end; only A, B and C are used
  GcodeFeed feed;
  double per_move = 0;  ///< G93: F, 1/min; the feed follows from the programmed length
  std::array<bool, 6> named{};
  std::size_t file = 0, line = 0;
};

/// A move of the tool center, or a dwell between such moves.
struct CompensatedMove {
  enum class Kind { kRapid, kFeed, kArc, kDwell };
  Kind kind = Kind::kFeed;
  PlanePoint end;
  PlanePoint center;   ///< kArc
  int turns = 0;       ///< kArc: as for arc_about
  double seconds = 0;  ///< kDwell
  CompensatedInfo info;
  double direction_first = 0, direction_second = 0;  ///< direction that shortening must not reverse
  double programmed_sweep_rad = 0;                   ///< kArc: sweep of the programmed arc; 0: any
};

/// Where the entry move of cutter compensation ends, from its programmed end.
enum class CompensationEntry {
  kAcrossEntry,  ///< across the entry move's own direction (LinuxCNC)
  kAcrossNext,   ///< across the start of the next move in the plane (Fanuc, Haas, SINUMERIK)
};

/// Cutter radius compensation (G41, G42) as computed by LinuxCNC: the tool center follows the
/// programmed path at a distance of its radius, rounds outside corners with an arc and stops at the
/// intersection in inside corners. A move is delayed until the next one determines the corner at
/// its end. Supports the planes XY and ZX. Throws ProgramFault for a path that the tool cannot
/// follow without gouging.
class CutterCompensation {
 public:
  using Emit = std::function<void(const CompensatedMove&)>;
  explicit CutterCompensation(Emit emit, CompensationEntry entry = CompensationEntry::kAcrossEntry)
      : emit_(std::move(emit)), entry_(entry) {}

  /// Turns compensation on. `side` > 0: left of the path (G41). A negative radius swaps the sides.
  void start(int side, double radius_mm, ArcPlane plane);
  /// The same with a tool that is already offset from `contour`, a point of the path, across its
  /// direction.
  void start_beside(int side, double radius_mm, ArcPlane plane, PlanePoint contour);
  /// Sets the program's length unit, on which LinuxCNC's tolerances depend.
  void set_unit(double unit_mm) { unit_mm_ = unit_mm; }
  /// Turns compensation off. The tool center stays at `at`. Returns the programmed point if the
  /// tool was offset from the path.
  std::optional<PlanePoint> end(PlanePoint at);
  /// Emits the delayed moves. The last one ends at the tool center, `at`.
  void flush(PlanePoint at);

  bool on() const { return side_ != 0; }
  /// Whether the entry move has been made, so that the tool is offset from the path.
  bool beside() const { return on() && beside_; }
  /// Whether moves have to go through straight() and arc().
  bool active() const { return on() && radius_ > 0; }
  int side() const { return side_; }
  ArcPlane plane() const { return plane_; }
  /// The programmed point; valid while beside().
  PlanePoint programmed() const { return programmed_; }

  /// Add a move to the programmed point `to`. `at` is the tool center. Both return the tool center
  /// at the end of the move.
  PlanePoint straight(bool rapid, PlanePoint at, PlanePoint to, CompensatedInfo info);
  PlanePoint arc(PlanePoint at, PlanePoint to, const ArcCenter& center, bool clockwise, int turns,
                 double spiral_tolerance_mm, CompensatedInfo info);
  void dwell(double seconds, const CompensatedInfo& info);

 private:
  /// Ends the entry move and later moves across the plane at a right angle to the start of the next
  /// move.
  void enter_beside(PlanePoint start);
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
  void push(const CompensatedMove& move);
  bool inside(int turns) const { return (side_ > 0) == (turns > 0); }
  bool waiting_arc() const {
    return !waiting_.empty() && waiting_.front().kind == CompensatedMove::Kind::kArc;
  }
  double quarter() const;

  Emit emit_;
  CompensationEntry entry_;
  bool entering_ = false;  ///< kAcrossNext: the entry move waits for the next one
  int side_ = 0;
  double radius_ = 0;
  double unit_mm_ = 1;
  ArcPlane plane_ = ArcPlane::kXy;
  bool beside_ = false;
  PlanePoint programmed_;
  std::vector<CompensatedMove> waiting_;    ///< delayed moves
  std::optional<PlanePoint> waiting_from_;  ///< start of the first delayed move
};

/// Whether the error means that a tool of this radius cannot follow the path. The program may
/// describe the path of the tool's center, with the wear as offset.
bool is_compensation_fault(std::string_view reason);

/// Returns the signed angle from `from` to `to` about a center, rad; `turns` as for arc_about, or
/// 0.
double sweep_rad(PlanePoint from, PlanePoint center, int turns, PlanePoint to);

}  // namespace kerf
