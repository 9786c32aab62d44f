// SPDX-License-Identifier: Apache-2.0
#include "server/formats/program.h"

#include <cctype>

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
  for (const std::string_view known : {"apt", "cls", "aptsource", "cl", "cld", "cldata", "ncl"})
    if (extension == known) return ProgramFormat::kApt;
  for (const std::string_view known :
       {"ngc", "nc",  "tap", "gcode", "cnc", "eia", "iso", "din", "min", "gc",  "g",   "mpf",
        "h",   "txt", "fnc", "nct",   "ncc", "ptp", "pim", "anc", "spf", "pgm", "prg", "hnc"})
    if (extension == known) return ProgramFormat::kGcode;
  return std::unexpected(
      ProgramError{std::string(file_name), 0, "",
                   "the extension must be nc, ngc, cnc, tap, gcode, txt, eia, iso, din, min, gc, "
                   "g, mpf, spf, h, hnc, fnc, nct, ncc, ptp, pim, anc, pgm or prg for G-code, or "
                   "apt, aptsource, cl, cld, cldata, cls or ncl for APT"});
}

std::string place_of(const Program& program, std::uint32_t file, std::uint32_t line) {
  return (file < program.files.size() ? program.files[file] : program.name) + ":" +
         std::to_string(line);
}

}  // namespace kerf
