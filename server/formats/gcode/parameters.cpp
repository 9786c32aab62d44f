// SPDX-License-Identifier: Apache-2.0
#include "server/formats/gcode/parameters.h"

#include <algorithm>

#include "server/formats/gcode/fault.h"

namespace kerf {

bool is_gcode_parameter_writable(int number) {
  using namespace gcode_parameter;
  return !(number >= kTool && number <= kToolOrientation) &&
         !(number >= kPosition && number <= kPositionLast);
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
    throw GcodeFault{"#<" + name + ">", "is read-only: it holds a state of the machine"};
  auto& scope = scope_of(name);
  const auto it = scope.find(name);
  if (it != scope.end()) {
    it->second = value;
    return;
  }
  if (scope.size() >= kGcodeNamesMax)
    throw GcodeFault{"#<" + name + ">", "exceeds the limit of " + std::to_string(kGcodeNamesMax) +
                                            " names in one scope"};
  scope.emplace(name, value);
}

void GcodeParameters::enter(const std::vector<double>& arguments) {
  const auto first = numbered_.begin() + 1;
  Scope scope;
  scope.callers_arguments.assign(first, first + kGcodeLocalParameters);
  std::fill(first, first + kGcodeLocalParameters, 0.0);
  std::copy_n(arguments.begin(),
              std::min(arguments.size(), static_cast<std::size_t>(kGcodeLocalParameters)), first);
  scopes_.push_back(std::move(scope));
}

void GcodeParameters::enter_sharing() { scopes_.emplace_back(); }

void GcodeParameters::leave() {
  const std::vector<double> arguments = std::move(scopes_.back().callers_arguments);
  scopes_.pop_back();
  std::copy(arguments.begin(), arguments.end(), numbered_.begin() + 1);
}

}  // namespace kerf
