// SPDX-License-Identifier: Apache-2.0
#include "server/formats/gcode/parameters.h"

#include <algorithm>
#include <limits>

#include "server/formats/control/fault.h"

namespace kerf {

bool is_gcode_parameter_writable(int number) {
  using namespace gcode_parameter;
  return !(number >= kTool && number <= kToolOrientation) &&
         !(number >= kPosition && number <= kPositionLast);
}

bool is_tool_life_count(int number) {
  return (number >= 5401 && number <= 5600) || (number >= 5701 && number <= 5800);
}

bool is_macro_variable(int number, bool assigned) {
  using namespace gcode_parameter;
  const auto within = [number](int first, int last) { return number >= first && number <= last; };
  if (within(1, kMacroLocalParameters) || within(100, 999)) return true;
  if (within(10000, kMacroParameterMax)) return true;  // more common ones of Haas
  // Six axes of each system. LinuxCNC's own values, such as a rotation, follow them.
  const auto is_axis = [&](int first, int systems) {
    return within(first, first + systems * kSystemStride - 1) &&
           (number - first) % kSystemStride < 6;
  };
  if (is_axis(kSystem + kSystemStride, 6) || is_axis(kMoreSystemsFirst, 99)) return true;
  if (assigned) return false;
  return number == 0 || within(kModal + 1, kModal + 130) || within(kMacroEnd, kMacroEnd + 5) ||
         within(kMacroPosition, kMacroPosition + 5);
}

GcodeParameters GcodeParameters::of_macros(bool vacant) {
  constexpr double kVacant = std::numeric_limits<double>::quiet_NaN();
  GcodeParameters parameters;
  parameters.macros_ = true;
  parameters.vacant_ = vacant;
  parameters.numbered_.assign(kMacroParameterMax + 1, 0.0);
  if (!vacant) return parameters;
  parameters.set(0, kVacant);
  for (int i = 1; i <= kMacroParameterMax; ++i)
    if (i <= kMacroLocalParameters || (i >= 100 && i < 1000) || i >= 10000)
      parameters.set(i, kVacant);
  return parameters;
}

std::map<std::string, double>& GcodeParameters::scope_of(const std::string& name) {
  return name.starts_with('_') ? scopes_.front().named : scopes_.back().named;
}

const std::map<std::string, double>& GcodeParameters::scope_of(const std::string& name) const {
  return name.starts_with('_') ? scopes_.front().named : scopes_.back().named;
}

std::optional<double> GcodeParameters::named(const std::string& name) const {
  if (name.starts_with('_') && predefined_)
    if (const auto value = predefined_(name)) return value;
  const auto& scope = scope_of(name);
  const auto it = scope.find(name);
  return it == scope.end() ? std::nullopt : std::optional(it->second);
}

void GcodeParameters::set(const std::string& name, double value) {
  if (name.starts_with('_') && predefined_ && predefined_(name))
    throw ProgramFault{"#<" + name + ">", "is read-only: it holds a state of the machine"};
  auto& scope = scope_of(name);
  const auto it = scope.find(name);
  if (it != scope.end()) {
    it->second = value;
    return;
  }
  if (scope.size() >= kGcodeNamesMax)
    throw ProgramFault{"#<" + name + ">", "exceeds the limit of " + std::to_string(kGcodeNamesMax) +
                                              " names in one scope"};
  scope.emplace(name, value);
}

void GcodeParameters::enter(const std::vector<double>& arguments) {
  const auto first = numbered_.begin() + 1;
  const auto count = static_cast<std::size_t>(locals());
  Scope scope;
  scope.callers_arguments.assign(first, first + locals());
  std::fill(first, first + locals(), vacant_ ? std::numeric_limits<double>::quiet_NaN() : 0.0);
  std::copy_n(arguments.begin(), std::min(arguments.size(), count), first);
  scopes_.push_back(std::move(scope));
}

void GcodeParameters::enter_sharing() { scopes_.emplace_back(); }

void GcodeParameters::leave() {
  const std::vector<double> arguments = std::move(scopes_.back().callers_arguments);
  scopes_.pop_back();
  std::copy(arguments.begin(), arguments.end(), numbered_.begin() + 1);
}

}  // namespace kerf
