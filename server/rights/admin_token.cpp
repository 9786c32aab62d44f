// SPDX-License-Identifier: Apache-2.0
#include "server/rights/admin_token.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <system_error>

#include "server/store/resume_token.h"

namespace kerf {
namespace {

constexpr const char* kVariable = "KERF_ADMIN_TOKEN";

std::expected<std::string, std::string> make_file(const std::string& file) {
  const auto fail = [&] {
    return std::unexpected(file + ": " + std::generic_category().message(errno));
  };
  const auto token = random_token();
  if (!token) return std::unexpected("the system gives no random numbers");
  const int out = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (out < 0) return fail();
  const std::string line = *token + "\n";
  const bool written =
      ::write(out, line.data(), line.size()) == static_cast<ssize_t>(line.size()) &&
      ::fsync(out) == 0;
  const auto failure = written ? std::expected<std::string, std::string>(*token) : fail();
  ::close(out);
  if (!written) ::unlink(file.c_str());
  return failure;
}

}  // namespace

std::expected<std::string, std::string> read_admin_token(const std::string& file) {
  if (file.empty()) {
    const char* given = std::getenv(kVariable);
    std::string token = given == nullptr ? "" : given;
    unsetenv(kVariable);
    return token;
  }
  std::ifstream in(file);
  if (!in) return errno == ENOENT ? make_file(file) : std::unexpected(file + ": cannot be read");
  std::string token;
  std::getline(in, token);
  while (!token.empty() && (token.back() == '\r' || token.back() == ' ')) token.pop_back();
  if (token.empty()) return std::unexpected(file + ": is empty; remove it to get a new token");
  return token;
}

}  // namespace kerf
