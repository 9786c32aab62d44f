// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/device_profile.h"

#include <array>
#include <fstream>
#include <functional>
#include <limits>
#include <sstream>
#include <string_view>

#include "haptic_agent/device/text_fields.h"

namespace kerf::agent {
namespace {

constexpr std::string_view kHead = "kerf-device-profile 1";

struct Number {
  std::string_view name;
  double least, most;
  void (*set)(DeviceProfile& profile, double value);
};

constexpr double kMostLatencyUs = 20'000;
constexpr std::array<Number, 9> kNumbers = {{
    {"latency_us", 0, kMostLatencyUs,
     [](DeviceProfile& p, double v) { p.latency_us = static_cast<std::uint64_t>(v); }},
    {"resolution_mm", 0, 1, [](DeviceProfile& p, double v) { p.resolution_mm = v; }},
    {"resolution_rad", 0, 0.1, [](DeviceProfile& p, double v) { p.resolution_rad = v; }},
    {"moving_mass_kg", 1e-4, 100, [](DeviceProfile& p, double v) { p.moving_mass_kg = v; }},
    {"moving_inertia_kg_m2", 1e-8, 10,
     [](DeviceProfile& p, double v) { p.moving_inertia_kg_m2 = v; }},
    {"friction_n", 0, 100, [](DeviceProfile& p, double v) { p.friction_n = v; }},
    {"viscous_n_s_per_mm", 0, 10, [](DeviceProfile& p, double v) { p.viscous_n_s_per_mm = v; }},
    {"wall_along_n_per_mm", 0, 1000, [](DeviceProfile& p, double v) { p.wall_along_n_per_mm = v; }},
    {"wall_across_n_per_mm", 0, 1000,
     [](DeviceProfile& p, double v) { p.wall_across_n_per_mm = v; }},
}};

/// Parses one line into the profile; returns the error, or an empty string.
std::string take_line(DeviceProfile& profile, std::string_view line) {
  const std::size_t space = line.find(' ');
  const std::string_view name = line.substr(0, space);
  const std::string_view text = space == std::string_view::npos ? "" : trim(line.substr(space));
  if (name == "device") {
    profile.device = text;
    return {};
  }
  for (const Number& number : kNumbers) {
    if (number.name != name) continue;
    const auto value = to_number(text);
    if (!value || !(*value >= number.least && *value <= number.most)) {
      std::ostringstream out;
      out << name << " must be a number from " << number.least << " to " << number.most;
      return out.str();
    }
    number.set(profile, *value);
    return {};
  }
  return join({"unknown name '", name, "'"});
}

}  // namespace

DeviceCapabilities with_profile(DeviceCapabilities declared,
                                const std::optional<DeviceProfile>& profile) {
  if (!profile) return declared;
  declared.latency_us = profile->latency_us.value_or(declared.latency_us);
  declared.resolution_mm = profile->resolution_mm.value_or(declared.resolution_mm);
  declared.resolution_rad = profile->resolution_rad.value_or(declared.resolution_rad);
  declared.moving_mass_kg = profile->moving_mass_kg.value_or(declared.moving_mass_kg);
  declared.moving_inertia_kg_m2 =
      profile->moving_inertia_kg_m2.value_or(declared.moving_inertia_kg_m2);
  return declared;
}

std::expected<DeviceProfile, std::string> read_profile(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  if (!file) return std::unexpected("cannot read " + path);
  if (!std::getline(file, line) || trim(line) != kHead) {
    return std::unexpected(join({path, " is no device profile: its first line must be '", kHead,
                                 "'; kerf-agent doctor --identify writes one"}));
  }
  DeviceProfile profile;
  for (int number = 2; std::getline(file, line); ++number) {
    const std::string_view text = trim(line);
    if (text.empty() || text.front() == '#') continue;
    if (const std::string wrong = take_line(profile, text); !wrong.empty())
      return std::unexpected(join({path, ":", std::to_string(number), ": ", wrong}));
  }
  return profile;
}

std::expected<void, std::string> write_profile(const std::string& path,
                                               const DeviceProfile& profile) {
  std::ofstream file(path);
  file.precision(std::numeric_limits<float>::digits10);
  file << kHead << '\n';
  if (!profile.device.empty()) file << "device " << profile.device << '\n';
  const auto put = [&file](const char* name, const auto& value) {
    if (value) file << name << ' ' << *value << '\n';
  };
  put("latency_us", profile.latency_us);
  put("resolution_mm", profile.resolution_mm);
  put("resolution_rad", profile.resolution_rad);
  put("moving_mass_kg", profile.moving_mass_kg);
  put("moving_inertia_kg_m2", profile.moving_inertia_kg_m2);
  file << "friction_n " << profile.friction_n << "\nviscous_n_s_per_mm "
       << profile.viscous_n_s_per_mm << "\nwall_along_n_per_mm " << profile.wall_along_n_per_mm
       << "\nwall_across_n_per_mm " << profile.wall_across_n_per_mm << '\n';
  file.close();
  if (!file) return std::unexpected("cannot write " + path);
  return {};
}

}  // namespace kerf::agent
