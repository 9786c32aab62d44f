// SPDX-License-Identifier: Apache-2.0
#include "server/formats/gcode/dialect.h"

#include <utility>

namespace kerf {
namespace {

constexpr std::string_view kAutoName = "auto";

/// Languages that are no dialect of G-code.
constexpr std::array kOthers{std::pair{Dialect::kHeidenhain, std::string_view("heidenhain")},
                             std::pair{Dialect::kSiemens, std::string_view("siemens")}};

constexpr std::array kRules{
    DialectRules{.dialect = Dialect::kLinuxcnc, .name = "linuxcnc", .label = "LinuxCNC"},
    DialectRules{.dialect = Dialect::kGrbl,
                 .name = "grbl",
                 .label = "grbl",
                 .macros = true,
                 .retract_to_r = false},
    DialectRules{.dialect = Dialect::kMach3,
                 .name = "mach3",
                 .label = "Mach3",
                 .macros = true,
                 .retract_to_r = false},
    DialectRules{.dialect = Dialect::kFanuc,
                 .name = "fanuc",
                 .label = "Fanuc",
                 .macros = true,
                 .vacant = true,
                 .retract_to_r = false,
                 .dwell_unit_s = 0.001},
    DialectRules{.dialect = Dialect::kHaas,
                 .name = "haas",
                 .label = "Haas",
                 .macros = true,
                 .vacant = true,
                 .retract_to_r = false,
                 .dwell_unit_s = 0.001},
};

}  // namespace

const DialectRules& rules_of(Dialect dialect) {
  for (const DialectRules& rules : kRules)
    if (rules.dialect == dialect) return rules;
  return kRules.front();
}

std::optional<Dialect> dialect_of(std::string_view name) {
  if (name == kAutoName) return Dialect::kAuto;
  for (const auto& [dialect, other] : kOthers)
    if (name == other) return dialect;
  for (const DialectRules& rules : kRules)
    if (rules.name == name) return rules.dialect;
  return std::nullopt;
}

std::string_view name_of(Dialect dialect) {
  if (dialect == Dialect::kAuto) return kAutoName;
  for (const auto& [other, name] : kOthers)
    if (dialect == other) return name;
  return rules_of(dialect).name;
}

std::string dialect_names() {
  std::string names(kAutoName);
  for (const DialectRules& rules : kRules) names.append(", ").append(rules.name);
  for (const auto& [dialect, other] : kOthers) names.append(", ").append(other);
  return names;
}

}  // namespace kerf
