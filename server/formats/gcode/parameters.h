// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace kerf {

/// Highest number of a parameter. The lowest is 1 (LinuxCNC's limit).
inline constexpr int kGcodeParameterMax = 5601;
/// Highest number and highest local one of Macro B (Fanuc, Haas, Mach3).
inline constexpr int kMacroParameterMax = 10999;
inline constexpr int kMacroLocalParameters = 33;
/// #1 to #30 are local to a subroutine and receive its arguments.
inline constexpr int kGcodeLocalParameters = 30;
/// Most named parameters in one scope. Bounds the memory of hostile loops.
inline constexpr std::size_t kGcodeNamesMax = 10'000;

/// Numbers of the parameters with a special meaning, as in LinuxCNC. The offsets X Y Z A B C U V W
/// R of coordinate system n (1 to 9) start at kSystem + kSystemStride * n.
namespace gcode_parameter {
inline constexpr int kProbe = 5061;
inline constexpr int kProbeTripped = 5070;
inline constexpr int kHome28 = 5161;
inline constexpr int kHome30 = 5181;
inline constexpr int kShiftApplied = 5210;
inline constexpr int kShift = 5211;
inline constexpr int kSelectedSystem = 5220;
inline constexpr int kSystem = 5201;
inline constexpr int kSystemStride = 20;
inline constexpr int kSystemRotation = 9;  ///< R, relative to the X of its system
inline constexpr int kInput = 5399;
/// Macro B: modal codes and words (#4001 to #4130), end of the last block, current position.
inline constexpr int kModal = 4000;
inline constexpr int kMacroEnd = 5001;
inline constexpr int kMacroPosition = 5041;
/// Macro B: offsets of the additional coordinate systems (G54.1 P1: number 10), stride
/// kSystemStride.
inline constexpr int kMoreSystemsFirst = 7001;
inline constexpr int kMoreSystemsMax = 99;
inline constexpr int kTool = 5400;
inline constexpr int kToolOffset = 5401;
inline constexpr int kToolDiameter = 5410;
inline constexpr int kToolFrontAngle = 5411;
inline constexpr int kToolBackAngle = 5412;
inline constexpr int kToolOrientation = 5413;
inline constexpr int kPosition = 5420;
inline constexpr int kPositionLast = 5428;
inline constexpr int kDebug = 5599;
}  // namespace gcode_parameter

/// The #-parameters of a running program. Numbered parameters are 0 until assigned. Named ones do
/// not exist until assigned. Names with a leading '_' are global, all other names local to the
/// subroutine that assigns them. Throws ProgramFault.
class GcodeParameters {
 public:
  /// Returns the value of a predefined parameter (#<_x>, #<_feed>, …), or nullopt for other names.
  GcodeParameters() = default;
  /// The variables of Macro B: up to kMacroParameterMax, 33 local ones. If `vacant`, local (#1 to
  /// #33) and common ones (#100 to #999, #10000 to #10999) are vacant (NaN) until they are
  /// assigned.
  static GcodeParameters of_macros(bool vacant);
  bool macros() const { return macros_; }
  bool vacant() const { return vacant_; }
  /// Whether the program has read the usage of a tool.
  bool tool_life_read() const { return tool_life_read_; }
  void note_tool_life() const { tool_life_read_ = true; }
  int max() const { return static_cast<int>(numbered_.size()) - 1; }

  using Predefined = std::function<std::optional<double>(const std::string&)>;
  void set_predefined(Predefined predefined) { predefined_ = std::move(predefined); }

  /// `number` from 1 to kGcodeParameterMax.
  double numbered(int number) const { return numbered_[static_cast<std::size_t>(number)]; }
  void set(int number, double value) { numbered_[static_cast<std::size_t>(number)] = value; }

  std::optional<double> named(const std::string& name) const;
  /// Throws for a predefined name and for more than kGcodeNamesMax names.
  void set(const std::string& name, double value);
  /// Creates a name with the value 0 if it does not exist. As in LinuxCNC, a name exists from the
  /// point where its assignment is read.
  void declare(const std::string& name) {
    if (!named(name)) set(name, 0);
  }

  /// Opens the scope of a called subroutine and sets #1 to #30 to its arguments.
  void enter(const std::vector<double>& arguments);
  /// Opens the scope of a subroutine that shares #1 to #30 with its caller (M98).
  void enter_sharing();
  /// Closes the innermost scope and restores #1 to #30 of the caller.
  void leave();

 private:
  struct Scope {
    std::map<std::string, double> named;
    std::vector<double> callers_arguments;  ///< #1 to #30 of the caller; empty if shared
  };
  std::map<std::string, double>& scope_of(const std::string& name);
  const std::map<std::string, double>& scope_of(const std::string& name) const;

  int locals() const { return macros_ ? kMacroLocalParameters : kGcodeLocalParameters; }

  bool macros_ = false, vacant_ = false;
  mutable bool tool_life_read_ = false;
  std::vector<double> numbered_ = std::vector<double>(kGcodeParameterMax + 1);
  std::vector<Scope> scopes_ = std::vector<Scope>(1);
  Predefined predefined_;
};

/// Returns whether a variable of Fanuc and Haas counts the usage of a tool (#5401 to #5600: times,
/// #5701 to #5800: uses). They are 0, because a program starts with new tools.
bool is_tool_life_count(int number);
/// Returns whether Macro B may read (or assign) a variable, which is true for those with a meaning
/// here.
bool is_macro_variable(int number, bool assigned);
/// Returns whether a program may assign a parameter: all except those of the tool and the position.
bool is_gcode_parameter_writable(int number);

}  // namespace kerf
