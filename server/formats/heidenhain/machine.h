// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "server/formats/control/area_path.h"
#include "server/formats/control/corner.h"
#include "server/formats/heidenhain/blocks.h"
#include "server/formats/heidenhain/path.h"
#include "server/formats/heidenhain/values.h"

namespace kerf {

/// Executes the blocks of a Klartext program that move, or change a tool or the coordinates. Errors
/// are ProgramFault.
class KlartextMachine {
 public:
  using Warn = std::function<void(const std::string&)>;
  /// `offsets_are_wear`: the path is that of the tool's center, so RL has no offset.
  KlartextMachine(const Scene& scene, MotionSink& sink, KlartextValues& values, Warn warn,
                  bool offsets_are_wear);

  /// Executes a block. `following` is the text of the next one, because a corner (RND, CHF) changes
  /// the line before it. Returns true at the end of the program.
  bool execute(const KlartextBlock& block, const std::string& following);
  /// Completes the path. Throws if a corner has begun and not ended.
  void finish();

 private:
  using Words = std::vector<KlartextWord>;
  struct Corner {
    Vec3 at;
    double feed = 0;
    std::optional<double> own_feed;  ///< of the corner
    CornerSize size;
  };
  // The M words and FMAX of a block.
  struct Extras {
    bool rapid = false, in_machine = false, calls_cycle = false, ends = false;
    bool datum_of_builder = false;     ///< M92
    std::optional<double> retract_mm;  ///< M140 MB; infinite for MAX
  };

  void begin(const std::string& text);
  bool path_function(std::string_view word, Words words, const std::string& following);
  void call_tool(std::string text);
  void tool_word(const Words& words, std::size_t& at);
  void tool_center(const std::string& text);
  void refuse_in_corner(const std::string& word) const;
  double tool_radius_mm(const std::string& word) const;
  void compensate(const std::string& word);
  void refuse_off_axis(const std::string& word) const;
  void cycle_definition(const std::string& text);
  void datum_shift(const Words& words);
  void rotate(const Words& words);
  void tilt(const std::string& text);
  void tilt_by_angles(const Words& words);
  void tilt_by_vectors(const Words& words);
  void finish_tilt(bool positions);
  void reset_plane();
  void working_plane(const Words& words);
  void old_pecking(const std::string& number, const std::string& rest);
  void miscellaneous(const Words& words);

  void linear(const Words& words, const Extras& extras, bool corner_follows);
  void linear_with_vectors(Words words, const Extras& extras);
  std::optional<Vec3> take_vector(Words& words, char kind) const;
  void polar_line(const Words& words, const Extras& extras, bool corner_follows);
  void straight(Vec3 to, const Extras& extras, std::array<bool, 3> named, bool corner_follows);
  void to_machine(const Words& words, const Extras& extras);
  void pole(const Words& words);
  void circle(const Words& words);
  void polar_circle(const Words& words);
  void circle_by_radius(const Words& words);
  void tangent_circle(const Words& words);
  void corner(const Words& words, bool chamfer);
  void cut_corner(Vec3 next);
  void approach(const std::string& text);
  void approach_sizes(Words& words, KlartextApproach& to) const;
  static void check_departure_words(const Words& words);
  void depart(const std::string& text);
  std::map<std::string, double> cycle_parameters(const std::string& text);
  double cycle_value(const char* name, double missing) const;
  void call_cycle(double raised_mm = 0);
  void call_at(const Words& words);
  void drill(double raised_mm);
  void call_pattern(int cycle, const std::map<std::string, double>& given);
  static bool is_area_cycle(int cycle);
  AreaPath area(double tool_mm, double allowance_mm) const;
  void mill_area(double raised_mm);
  void follow(const AreaPath& path);

  Extras read_extras(Words& words);
  void m_code(int code, const Words& words, std::size_t at, Extras& extras);
  void remark(int code);
  void turn_spindle(MachineRemark::Kind direction);
  double mm(const KlartextWord& word) const;
  Vec3 target(const Words& words, std::array<bool, 3>& named) const;
  Vec3 place() const;
  RotaryAngles rotary_target(const Words& words, bool& turns);
  double feed() const;
  void move(Vec3 to, std::optional<double> feed, std::array<bool, 3> named);
  void move_arc(Vec3 to, ArcPlane plane, Vec3 center, int turns);
  static bool clockwise(const Words& words);
  static constexpr double kVectorMin = 1e-6;  ///< shorter vectors have no direction
  static const KlartextWord* find(const Words& words, const std::string& name);

  const Scene& scene_;
  KlartextValues& values_;
  Warn warn_;
  const bool offsets_are_wear_;
  KlartextPath path_;
  double unit_mm_ = 1;
  std::optional<double> feed_;
  double rpm_ = 0;
  double oversize_mm_ = 0;  ///< DR of TOOL CALL, added to the tool's radius for RL, RR and cycles
  std::optional<MachineRemark::Kind> turning_;  ///< direction of the spindle
  std::map<std::string, ToolId> named_tools_;
  Vec3 pole_{0, 0, 0};
  ArcPlane pole_plane_ = ArcPlane::kXy;
  bool pole_known_ = false;
  std::optional<Vec3> direction_;  ///< of the path at its end
  std::optional<Corner> corner_;
  std::map<std::string, double> cycle_;  ///< of CYCL DEF 2xx: "Q200"; empty: none
  int cycle_number_ = 0;
  bool cycle_modal_ = false;
  bool shortest_ = false;  ///< M126: tables take the shorter turn
};

}  // namespace kerf
