// SPDX-License-Identifier: Apache-2.0
// LinuxCNC's predefined named parameters that depend on the state of the interpreter.
#include "server/formats/gcode/machine.h"

namespace kerf {
namespace {

double flag(bool yes) { return yes ? 1 : 0; }

}  // namespace

const GcodeMachine::Predefined GcodeMachine::kPredefined[] = {
    {"_line", [](const GcodeMachine& m) -> double { return static_cast<double>(m.line_); }},
    {"_motion_mode", [](const GcodeMachine& m) -> double { return m.modes_.motion; }},
    {"_plane",
     [](const GcodeMachine& m) -> double {
       return m.modes_.plane == ArcPlane::kXy ? 170 : m.modes_.plane == ArcPlane::kZx ? 180 : 190;
     }},
    {"_ccomp",
     [](const GcodeMachine& m) -> double {
       return !m.compensation_.on() ? 400 : m.compensation_.side() > 0 ? 410 : 420;
     }},
    {"_metric", [](const GcodeMachine& m) -> double { return flag(m.modes_.unit_mm == 1); }},
    {"_imperial", [](const GcodeMachine& m) -> double { return flag(m.modes_.unit_mm != 1); }},
    {"_absolute", [](const GcodeMachine& m) -> double { return flag(!m.modes_.incremental); }},
    {"_incremental", [](const GcodeMachine& m) -> double { return flag(m.modes_.incremental); }},
    {"_inverse_time",
     [](const GcodeMachine& m) -> double {
       return flag(m.modes_.feed_mode == GcodeFeedMode::kInverseTime);
     }},
    {"_units_per_minute",
     [](const GcodeMachine& m) -> double {
       return flag(m.modes_.feed_mode == GcodeFeedMode::kPerMinute);
     }},
    {"_units_per_rev",
     [](const GcodeMachine& m) -> double {
       return flag(m.modes_.feed_mode == GcodeFeedMode::kPerRevolution);
     }},
    {"_coord_system",
     [](const GcodeMachine& m) -> double {
       return m.modes_.system < 7 ? 530 + 10 * m.modes_.system : 584 + m.modes_.system;
     }},
    {"_tool_offset",
     [](const GcodeMachine& m) -> double { return flag(m.tool_offset_ != GcodeAxes{}); }},
    {"_retract_r_plane",
     [](const GcodeMachine& m) -> double { return flag(m.modes_.retract_to_r); }},
    {"_retract_old_z",
     [](const GcodeMachine& m) -> double { return flag(!m.modes_.retract_to_r); }},
    {"_spindle_rpm_mode",
     [](const GcodeMachine& m) -> double { return flag(!m.modes_.surface_speed); }},
    {"_spindle_css_mode",
     [](const GcodeMachine& m) -> double { return flag(m.modes_.surface_speed); }},
    {"_ijk_absolute_mode",
     [](const GcodeMachine& m) -> double { return flag(m.modes_.arc_absolute); }},
    {"_lathe_diameter_mode", [](const GcodeMachine&) -> double { return 0; }},
    {"_lathe_radius_mode", [](const GcodeMachine&) -> double { return 1; }},
    {"_spindle_on",
     [](const GcodeMachine& m) -> double {
       return flag(m.modes_.spindle != GcodeSpindle::kStopped);
     }},
    {"_spindle_cw",
     [](const GcodeMachine& m) -> double {
       return flag(m.modes_.spindle == GcodeSpindle::kClockwise);
     }},
    {"_mist", [](const GcodeMachine& m) -> double { return flag(m.modes_.mist); }},
    {"_flood", [](const GcodeMachine& m) -> double { return flag(m.modes_.flood); }},
    {"_speed_override",
     [](const GcodeMachine& m) -> double { return flag(m.modes_.speed_override); }},
    {"_feed_override",
     [](const GcodeMachine& m) -> double { return flag(m.modes_.feed_override); }},
    {"_adaptive_feed",
     [](const GcodeMachine& m) -> double { return flag(m.modes_.adaptive_feed); }},
    {"_feed_hold", [](const GcodeMachine& m) -> double { return flag(m.modes_.feed_hold); }},
    {"_feed", [](const GcodeMachine& m) -> double { return m.modes_.feed_deg; }},
    {"_rpm", [](const GcodeMachine& m) -> double { return m.modes_.spindle_rpm; }},
    {"_current_tool", [](const GcodeMachine& m) -> double { return m.loaded_tool_; }},
    {"_selected_tool",
     [](const GcodeMachine& m) -> double { return m.selected_tool_.value_or(0); }},
    {"_current_pocket",
     [](const GcodeMachine& m) -> double { return m.pocket(m.loaded_tool_, 0); }},
    {"_selected_pocket",
     [](const GcodeMachine& m) -> double { return m.pocket(m.selected_tool_, -1); }},
    {"_value", [](const GcodeMachine& m) -> double { return m.returned_.value_or(0); }},
    {"_value_returned",
     [](const GcodeMachine& m) -> double { return flag(m.returned_.has_value()); }},
    {"_call_level",
     [](const GcodeMachine& m) -> double { return static_cast<double>(m.saved_.size() - 1); }},
    {"_remap_level", [](const GcodeMachine&) -> double { return 0; }},
    {"_task", [](const GcodeMachine&) -> double { return 0; }},
    {"_metric_machine",
     [](const GcodeMachine& m) -> double { return flag(m.setup_.machine_unit_mm == 1); }},
    {"_vmajor", [](const GcodeMachine&) -> double { return 2.9; }},
    {"_vminor", [](const GcodeMachine&) -> double { return 0; }},
};

// #<_x> to #<_c> and #<_abs_x> to #<_abs_c>, in the units of the program.
std::optional<double> GcodeMachine::predefined_position(const std::string& name) const {
  const bool absolute = name.size() == 6 && name.starts_with("_abs_");
  if (!absolute && name.size() != 2) return std::nullopt;
  const auto axis = kAxisLetters.find(name.back());
  if (axis == std::string_view::npos)
    return name.back() >= 'u' && name.back() <= 'w' ? std::optional(0.0) : std::nullopt;
  const double value = absolute ? (frame_.absolute(at_) + tool_offset_)[axis] : at_[axis];
  return axis < 3 ? value / modes_.unit_mm : value;
}

double GcodeMachine::pocket(std::optional<int> number, double standard) const {
  const ToolTableEntry* entry = number ? tool(*number) : nullptr;
  return entry != nullptr ? entry->pocket : standard;
}

std::optional<double> GcodeMachine::predefined(const std::string& name) const {
  if (const auto position = predefined_position(name)) return position;
  for (const auto& [key, value] : kPredefined)
    if (key == name) return value(*this);
  return std::nullopt;
}

}  // namespace kerf
