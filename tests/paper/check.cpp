// SPDX-License-Identifier: Apache-2.0
#include "tests/paper/check.h"

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <map>

namespace kerf::paper {

const std::vector<Check>& checks() {
  static const std::vector<Check> kChecks = [] {
    std::vector<Check> all;
    for (const auto& some :
         {volume_checks(), force_checks(), output_checks(), furniture_checks(), voxel_checks()}) {
      all.insert(all.end(), some.begin(), some.end());
    }
    return all;
  }();
  return kChecks;
}

const Finding& found(const std::string& name) {
  static std::map<std::string, Finding> findings;
  const auto known = findings.find(name);
  if (known != findings.end()) return known->second;
  const auto check =
      std::ranges::find_if(checks(), [&](const Check& one) { return one.name == name; });
  const Finding none{false, "there is no check of this name"};
  return findings[name] = check == checks().end() ? none : check->run();
}

std::string text(const char* format, ...) {
  char buffer[512];
  std::va_list numbers;
  va_start(numbers, format);
  std::vsnprintf(buffer, sizeof buffer, format, numbers);
  va_end(numbers);
  return buffer;
}

}  // namespace kerf::paper
