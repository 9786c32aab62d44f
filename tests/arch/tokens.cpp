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
