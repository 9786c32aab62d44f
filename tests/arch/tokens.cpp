// SPDX-License-Identifier: Apache-2.0
#include "tests/arch/tokens.h"

#include <regex>
#include <string>
#include <string_view>

namespace kerf::arch {
namespace {

struct Ban {
  std::string_view place;   ///< prefix of the path; empty: everywhere
  std::string_view except;  ///< prefix of the path that is exempt; empty: no exemption
  bool code;                ///< match code only, not comments and literals
  std::regex pattern;
  std::string_view reason;
};

// Words are split in two so that this file does not match its own rules.
const std::vector<Ban>& bans() {
  static const std::vector<Ban> kBans = {
      {"", "", false,
       std::regex("\\b(TO"
                  "DO|FIX"
                  "ME|XX"
                  "X|HA"
                  "CK)\\b"),
       "unfinished work belongs in an issue"},
      {"kernel/", "kernel/tool/", true,
       std::regex(R"(\b(a?(sin|cos|tan)h?|atan2|exp2?)"
                  R"(|expm1|log(2|10|1p)?|pow|cbrt|hypot|fma|sincos)f?\s*\()"),
       "libm results differ between CPUs; after tool definition only + - * / and sqrt are used"},
      {"", "", false,
       std::regex("-ffast-"
                  "math|-O"
                  "fast"),
       "fast-math breaks determinism: equal commands must give equal bytes"},
      {"haptic_agent/servo/", "", true,
       std::regex(R"(\b(new|malloc|calloc|realloc|make_unique|make_shared)\b)"),
       "the servo loop does not allocate"},
      {"haptic_agent/servo/", "", true,
       std::regex(R"(\b((shared_|recursive_|timed_)?mutex|lock_guard|unique_lock|scoped_lock)"
                  R"(|shared_lock|condition_variable)\b)"),
       "the servo loop does not lock"},
      {"haptic_agent/servo/", "", true, std::regex(R"(\b(throw|try|catch)\b)"),
       "the servo loop does not throw"},
      {"haptic_agent/servo/", "", true, std::regex(R"(\bsleep_for\b)"),
       "relative sleeps drift; the servo loop sleeps to absolute times"},
      {"haptic_agent/servo/", "", true, std::regex(R"(\b(cout|cerr|f?printf|spdlog|f?puts)\b)"),
       "the servo loop does not print"},
  };
  return kBans;
}

}  // namespace

std::vector<Violation> check_tokens(const Source& source) {
  std::vector<Violation> violations;
  const bool cpp = is_cpp(source.path);
  const std::string code = cpp ? code_only(source.text) : std::string();
  for (const Ban& ban : bans()) {
    const bool exempt = !ban.except.empty() && source.path.starts_with(ban.except);
    if (!source.path.starts_with(ban.place) || exempt || (ban.code && !cpp)) continue;
    std::size_t number = 0;
    for (const std::string_view line : lines_of(ban.code ? std::string_view(code) : source.text)) {
      ++number;
      std::cmatch match;
      if (std::regex_search(line.data(), line.data() + line.size(), match, ban.pattern)) {
        violations.push_back({source.path, number, match.str() + ": " + std::string(ban.reason)});
      }
    }
  }
  return violations;
}

}  // namespace kerf::arch
