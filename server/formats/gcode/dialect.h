// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

namespace kerf {

/// Controllers whose programs can be read; kAuto: judged by the program (dialect_choice.h).
enum class Dialect { kAuto, kLinuxcnc, kGrbl, kMach3, kFanuc, kHaas, kHeidenhain, kSiemens };

/// Rules of a controller's G-code. README.md names the manuals.
struct DialectRules {
  Dialect dialect = Dialect::kLinuxcnc;
  std::string_view name;   ///< of --dialect, e.g. "fanuc"
  std::string_view label;  ///< in messages, e.g. "Fanuc"
  /// Macro B instead of O words: IF, GOTO, WHILE, DO, END, M98, M99, G65. Also: the last of several
  /// codes of a modal group counts, comments nest, the machine starts in G0, unknown M codes do not
  /// move.
  bool macros = false;
  bool vacant = false;       ///< variables are vacant until they are assigned, not 0
  bool retract_to_r = true;  ///< starts in G99
  double dwell_unit_s = 1;   ///< seconds of G4 P1, written without a point

  /// Whether the codes are those of Fanuc, which Haas shares.
  bool of_fanuc() const { return dialect == Dialect::kFanuc || dialect == Dialect::kHaas; }
};

/// Returns the rules of a dialect, LinuxCNC's for kAuto and for languages with their own readers.
const DialectRules& rules_of(Dialect dialect);
/// Returns the dialect of a name, "auto" included, or nullopt.
std::optional<Dialect> dialect_of(std::string_view name);
/// Returns the name of a dialect, as dialect_of takes it.
std::string_view name_of(Dialect dialect);
/// All names, "auto" first, separated by ", ".
std::string dialect_names();

}  // namespace kerf
