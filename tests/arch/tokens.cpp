// SPDX-License-Identifier: Apache-2.0
#include "tests/arch/tokens.h"

#include <regex>
#include <string>
#include <string_view>

namespace kerf::arch {
namespace {

struct Ban {
  std::string_view place;   ///< prefix of the path; empty for everywhere
  std::string_view except;  ///< prefix of the path that is exempt; empty for no exemption
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
      {"kernel/", "kernel/math/tolerance.h", true, std::regex(R"(\b\d+(\.\d+)?[eE]-\d+)"),
       "an epsilon is named in kernel/math/tolerance.h, with its unit and owner"},
      {"server/", "", true, std::regex(R"(\b(parse_event_t|parser_callback_t)\b)"),
       "the parser with a callback takes time by the square: server/formats/bounded_json.h does "
       "not"},
  };
  return kBans;
}

// Clocks of the standard library may be named in types of times but never read.
constexpr const char* kClock =
    R"(\b((steady|system|high_resolution|file|utc|tai|gps)_clock\b)"
    R"((?!\s*(::\s*(time_point|duration)\b|[,>]))|clock_type\s*::\s*now\b)"
    R"(|(clock_gettime|gettimeofday|timespec_get|ftime|__(builtin_ia32_)?rdtscp?)\s*\()"
    R"(|time\s*\(\s*(nullptr|NULL|0|&\s*\w+)\s*\)|clock\s*\(\s*\)))";
constexpr const char* kRandom = R"(\b((random_device|RAND_\w+|arc4random\w*)\b|openssl/rand\.h\b)"
                                R"(|(getrandom|getentropy|s?rand(om)?(_r)?|[dejlmn]rand48)\s*\())";

// Sources of nondeterminism: a run must repeat exactly with the same input.
const std::vector<Ban>& outside_bans() {
  static const std::vector<Ban> kBans = [] {
    constexpr std::string_view kServer = "server/", kPlatform = "server/platform/";
    constexpr std::string_view kTime =
        "time comes from Clock (server/platform/clock.h), so that a test can decide about it";
    constexpr std::string_view kNumbers =
        "random numbers come from server/platform/random.h, so that a test can decide about them";
    constexpr std::string_view kNeither = "the kernel has neither time nor random numbers";
    return std::vector<Ban>{
        {kServer, kPlatform, true, std::regex(kClock), kTime},
        {kServer, kPlatform, true, std::regex(kRandom), kNumbers},
        {kServer, kPlatform, false, std::regex("/dev/u?random"), kNumbers},
        {"kernel/", "", true, std::regex(kClock), kNeither},
        {"kernel/", "", true, std::regex(kRandom), kNeither},
    };
  }();
  return kBans;
}

// Includes the folder that the servo thread shares with other threads.
constexpr std::string_view kRealtime[] = {"haptic_agent/servo/", "haptic_agent/realtime/"};

const std::vector<Ban>& realtime_bans() {
  static const std::vector<Ban> kBans = [] {
    std::vector<Ban> bans;
    for (const std::string_view place : kRealtime) {
      const auto ban = [&](const char* pattern, std::string_view reason) {
        bans.push_back({place, "", true, std::regex(pattern), reason});
      };
      ban(R"(\b(new|malloc|calloc|realloc|make_unique|make_shared)\b)",
          "the servo loop does not allocate");
      ban(R"(\b((shared_|recursive_|timed_)?mutex|lock_guard|unique_lock|scoped_lock)"
          R"(|shared_lock|condition_variable)\b)",
          "the servo loop does not lock");
      ban(R"(\b(throw|try|catch)\b)", "the servo loop does not throw");
      ban(R"(\bsleep_for\b)", "relative sleeps drift; the servo loop sleeps to absolute times");
      ban(R"(\b(cout|cerr|f?printf|spdlog|f?puts)\b)", "the servo loop does not print");
    }
    return bans;
  }();
  return kBans;
}

void check_bans(const Source& source, std::string_view code, const std::vector<Ban>& bans,
                std::vector<Violation>& violations) {
  for (const Ban& ban : bans) {
    const bool exempt = !ban.except.empty() && source.path.starts_with(ban.except);
    if (!source.path.starts_with(ban.place) || exempt) continue;
    if (ban.code && !is_cpp(source.path)) continue;
    std::size_t number = 0;
    for (const std::string_view line : lines_of(ban.code ? code : source.text)) {
      ++number;
      std::cmatch match;
      if (std::regex_search(line.data(), line.data() + line.size(), match, ban.pattern)) {
        violations.push_back({source.path, number, match.str() + ": " + std::string(ban.reason)});
      }
    }
  }
}

}  // namespace

std::vector<Violation> check_tokens(const Source& source) {
  const std::string code = is_cpp(source.path) ? code_only(source.text) : std::string();
  std::vector<Violation> violations;
  check_bans(source, code, bans(), violations);
  check_bans(source, code, outside_bans(), violations);
  check_bans(source, code, realtime_bans(), violations);
  return violations;
}

}  // namespace kerf::arch
