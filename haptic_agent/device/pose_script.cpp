// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/pose_script.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace kerf::agent {
namespace {

/// Files above this size are rejected before reading; 100 times the largest known program.
constexpr std::uintmax_t kMaxFileBytes = std::uintmax_t{512} << 20;

std::unexpected<ScriptError> reject(const std::string& path, std::string reason) {
  return std::unexpected(ScriptError{path, 0, std::move(reason)});
}

}  // namespace

std::string to_string(const ScriptError& error) {
  if (error.line == 0) return error.file + ": " + error.reason;
  return error.file + ":" + std::to_string(error.line) + ": " + error.reason;
}

double travel_time_s(const TimedPose& from, const TimedPose& to, const MoveSpeed& speed) noexcept {
  const double distance_mm = length(to.tip_mm - from.tip_mm);
  if (distance_mm > 0) return distance_mm / speed.tip_mm_per_s;
  const double turn_rad = std::atan2(length(cross(from.axis, to.axis)), dot(from.axis, to.axis));
  return turn_rad / speed.turn_rad_per_s;
}

std::expected<PoseScript, ScriptError> load_script(const std::string& path) {
  std::error_code failed;
  const auto bytes = std::filesystem::file_size(path, failed);
  if (failed) return reject(path, "cannot be read: " + failed.message());
  if (bytes > kMaxFileBytes) return reject(path, "must not be larger than 512 MiB");
  std::ifstream file(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  if (!file) return reject(path, "cannot be read");
  const std::string extension = std::filesystem::path(path).extension().string();
  if (extension == ".csv") return parse_csv_script(path, text);
  if (extension == ".apt" || extension == ".cls") return parse_apt_script(path, text);
  return reject(path, "is not a pose list: use an .apt, .cls or .csv file");
}

}  // namespace kerf::agent
