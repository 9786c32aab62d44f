// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/link/token.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <fstream>

namespace kerf::agent {
namespace {

constexpr const char* kVariable = "KERF_TOKEN";
constexpr std::string_view kLinkPart = "#invite=";
constexpr std::string_view kPunctuation = "_-.~+/=";
constexpr std::size_t kTokenBytesMax = 200;

std::string token_in(std::string text) {
  if (const auto part = text.find(kLinkPart); part != text.npos) {
    text.erase(0, part + kLinkPart.size());
  }
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back())) != 0) {
    text.pop_back();
  }
  return text;
}

}  // namespace

bool is_token(std::string_view text) noexcept {
  return !text.empty() && text.size() <= kTokenBytesMax &&
         std::ranges::all_of(text, [](unsigned char c) {
           return std::isalnum(c) != 0 ||
                  kPunctuation.find(static_cast<char>(c)) != kPunctuation.npos;
         });
}

std::expected<std::string, std::string> read_token(const std::string& file) {
  std::string text;
  if (file.empty()) {
    const char* given = std::getenv(kVariable);
    if (given == nullptr || *given == '\0') return text;
    text = given;
  } else {
    std::ifstream in(file);
    if (!in || !std::getline(in, text)) {
      return std::unexpected("the token file " + file + " cannot be read or is empty");
    }
  }
  text = token_in(std::move(text));
  if (is_token(text)) return text;
  return std::unexpected((file.empty() ? std::string(kVariable) : "the token file " + file) +
                         " does not hold a token or an invitation's link");
}

}  // namespace kerf::agent
