// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace kerf {

/// Numbered parameters run from 1 to this (LinuxCNC's limit).
inline constexpr int kGcodeParameterMax = 5601;
/// Each subroutine has these for itself: its arguments (#1 to #30).
inline constexpr int kGcodeLocalParameters = 30;
/// Most names in one scope: a loop may make up names without end.
inline constexpr std::size_t kGcodeNamesMax = 10'000;

/// Numbers of parameters with a meaning (LinuxCNC's). Those of coordinate system n (1 to 9) begin
/// at kSystem + 20 n: X Y Z A B C U V W R.
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
inline constexpr int kSystemRotation = 9;  ///< after the system's X
inline constexpr int kInput = 5399;
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

/// The #-parameters of a running program. Numbered ones are 0 until assigned; named ones do not
/// exist until assigned. Names that begin with '_' are global, others belong to the subroutine that
/// assigns them. Throws GcodeFault.
class GcodeParameters {
 public:
  /// Tells a predefined name (#<_x>, #<_feed>, …), or nothing where there is no such.
  using Predefined = std::function<std::optional<double>(const std::string&)>;
  void set_predefined(Predefined predefined) { predefined_ = std::move(predefined); }

  /// `number` from 1 to kGcodeParameterMax.
  double numbered(int number) const { return numbered_[static_cast<std::size_t>(number)]; }
  void set(int number, double value) { numbered_[static_cast<std::size_t>(number)] = value; }

  std::optional<double> named(const std::string& name) const;
  /// Rejects predefined names and one more than kGcodeNamesMax.
  void set(const std::string& name, double value);
  /// From where its assignment is read on, a new name exists with the value 0 (as in LinuxCNC).
  void declare(const std::string& name) {
    if (!named(name)) set(name, 0);
  }

  /// Names and arguments of a subroutine that is called; leave() gives those of the caller back.
  void enter(const std::vector<double>& arguments);
  void leave();
  /// A call that shares #1 to #30 with its caller (M98).
  void enter_sharing();

 private:
  struct Scope {
    std::map<std::string, double> named;
    std::vector<double> callers_arguments;  ///< empty where they are shared
  };
  std::map<std::string, double>& scope_of(const std::string& name);
  const std::map<std::string, double>& scope_of(const std::string& name) const;

  std::vector<double> numbered_ = std::vector<double>(kGcodeParameterMax + 1);
  std::vector<Scope> scopes_ = std::vector<Scope>(1);
  Predefined predefined_;
};

/// Whether a program may assign the parameter: not the tool's and not the position's.
bool is_gcode_parameter_writable(int number);

}  // namespace kerf
