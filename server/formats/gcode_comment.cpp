// SPDX-License-Identifier: Apache-2.0
#include "server/formats/gcode_comment.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "server/formats/letter_case.h"
#include "server/formats/program_writing.h"

namespace kerf {
namespace {

// LinuxCNC rejects lines of more than 255 bytes.
constexpr std::size_t kTextMax = 198;

constexpr std::array<std::string_view, 12> kActive = {
    "logopen",  "logappend", "log,", "logclose", "probeopen", "probeclose",
    "pyreload", "pyrun",     "py,",  "abort",    "debug,",    "print,"};

bool is_active(const std::string& text) {
  std::string begin;
  for (const char c : text)
    if (c != ' ' && begin.size() < 16) begin += to_lower(c);
  return std::ranges::any_of(kActive,
                             [&](std::string_view word) { return begin.starts_with(word); });
}

// Cuts a text after its last whole UTF-8 character.
void cut(std::string& text) {
  if (text.size() <= kTextMax) return;
  std::size_t size = kTextMax - 3;
  while (size > 0 && (static_cast<unsigned char>(text[size]) & 0xc0) == 0x80) --size;
  text.resize(size);
  text += "...";
}

}  // namespace

std::string gcode_comment(Post post, std::string text) {
  const bool capitals = post == Post::kFanuc || post == Post::kHaas;
  const bool ascii = capitals || post == Post::kGrbl;
  text = printable(capitals ? to_upper(std::move(text)) : std::move(text));
  for (char& c : text) {
    c = c == '(' ? '[' : c == ')' ? ']' : c;
    if (ascii && static_cast<unsigned char>(c) > 0x7e) c = '?';
    if (post == Post::kGrbl && (c == '?' || c == '!' || c == '~')) c = '_';
  }
  if (post == Post::kLinuxcnc && is_active(text)) text.insert(0, "- ");
  cut(text);
  return '(' + text + ')';
}

}  // namespace kerf
