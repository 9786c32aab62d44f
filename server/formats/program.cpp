// SPDX-License-Identifier: Apache-2.0
#include "server/formats/program.h"

#include <algorithm>
#include <cctype>

#include "server/formats/apt_reader.h"
#include "server/formats/gcode/reader.h"
#include "server/formats/heidenhain/blocks.h"
#include "server/formats/heidenhain/reader.h"
#include "server/formats/letter_case.h"

namespace kerf {
namespace {

// Longest quotation of a word in an error, bytes. Control characters are replaced.
constexpr std::size_t kQuoteMax = 60;

std::string quoted(const std::string& word) {
  std::string text = "'";
  text += word.substr(0, kQuoteMax);
  for (char& c : text)
    if (std::iscntrl(static_cast<unsigned char>(c)) != 0) c = '?';
  text += word.size() > kQuoteMax ? "…'" : "'";
  return text;
}

// A program that cuts nothing is rarely meant: it comes first among the warnings.
void warn_of_idle_program(Program& program) {
  const bool cuts = std::ranges::any_of(program.motions, [](const ProgramMotion& motion) {
    return !motion.rapid && !(motion.from == motion.to);
  });
  if (cuts) return;
  program.warnings.insert(program.warnings.begin(),
                          program.name + ": THE PROGRAM CUTS NOTHING: it ends after " +
                              std::to_string(program.lines) + " lines without a cutting motion");
}

}  // namespace

std::string to_string(const ProgramError& error) {
  std::string text = error.file + ":";
  if (error.line > 0) text += std::to_string(error.line) + ":";
  if (!error.word.empty()) text.append(" ").append(quoted(error.word));
  text.append(" ").append(error.reason);
  if (!error.language.empty()) text.append(" (read as ").append(error.language).append(")");
  return text;
}

std::expected<ProgramFormat, ProgramError> program_format(std::string_view file_name) {
  const std::size_t dot = file_name.rfind('.');
  const std::string extension =
      to_lower(std::string(dot == std::string_view::npos ? "" : file_name.substr(dot + 1)));
  if (extension == "apt" || extension == "cls") return ProgramFormat::kApt;
  for (const std::string_view known :
       {"ngc", "nc",  "tap", "gcode", "cnc", "eia", "iso", "din", "min", "gc",  "g",   "mpf",
        "h",   "txt", "fnc", "nct",   "ncc", "ptp", "pim", "anc", "spf", "pgm", "prg", "hnc"})
    if (extension == known) return ProgramFormat::kGcode;
  return std::unexpected(
      ProgramError{std::string(file_name), 0, "",
                   "the extension must be nc, ngc, cnc, tap, gcode, txt, eia, iso, din, min, gc, "
                   "g, mpf, spf, h, hnc, fnc, nct, ncc, ptp, pim, anc, pgm or prg for G-code, or "
                   "apt or cls for APT"});
}

std::expected<Program, ProgramError> parse_program(const std::string& name, std::string_view text,
                                                   const Scene& scene,
                                                   const GcodeEnvironment& environment) {
  const auto format = program_format(name);
  if (!format) return std::unexpected(format.error());
  // Some editors write a byte order mark before the first word.
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  const bool klartext = environment.dialect == Dialect::kAuto && is_klartext(text);
  auto program = *format == ProgramFormat::kApt ? read_apt(name, text, scene)
                 : klartext ? read_klartext(name, text, scene, environment.lines_max)
                            : read_gcode(name, text, scene, environment);
  if (program) warn_of_idle_program(*program);
  return program;
}

std::string place_of(const Program& program, std::uint32_t file, std::uint32_t line) {
  return (file < program.files.size() ? program.files[file] : program.name) + ":" +
         std::to_string(line);
}

}  // namespace kerf
