// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/device_profile.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <limits>
#include <sstream>
#include <string_view>

#include "haptic_agent/device/ranges.h"
#include "haptic_agent/device/text_fields.h"

namespace kerf::agent {
namespace {

constexpr std::string_view kHead = "kerf-device-profile 1";

/// A number of the file: its name, its range and its member, which is written always or only if
/// present.
struct Number {
  std::string_view name;
  double least, most;
  double DeviceProfile::* always = nullptr;
  std::optional<double> DeviceProfile::* optional = nullptr;
  /// Zero means not found, and is not written.
  bool nonzero = false;
};

constexpr double kMassMinKg = 1e-4, kInertiaMinKgM2 = 1e-8;
constexpr double kFrictionMaxN = 100, kViscousMaxNSPerMm = 10, kWallMaxNPerMm = 1000;
constexpr std::string_view kLatency = "latency_us";
constexpr std::array<Number, 8> kNumbers = {{
    {.name = "resolution_mm",
     .least = 0,
     .most = kResolutionMaxMm,
     .optional = &DeviceProfile::resolution_mm,
     .nonzero = true},
    {.name = "resolution_rad",
     .least = 0,
     .most = kResolutionMaxRad,
     .optional = &DeviceProfile::resolution_rad,
     .nonzero = true},
    {.name = "moving_mass_kg",
     .least = kMassMinKg,
     .most = kMovingMassMaxKg,
     .optional = &DeviceProfile::moving_mass_kg},
    {.name = "moving_inertia_kg_m2",
     .least = kInertiaMinKgM2,
     .most = kMovingInertiaMaxKgM2,
     .optional = &DeviceProfile::moving_inertia_kg_m2},
    {.name = "friction_n", .least = 0, .most = kFrictionMaxN, .always = &DeviceProfile::friction_n},
    {.name = "viscous_n_s_per_mm",
     .least = 0,
     .most = kViscousMaxNSPerMm,
     .always = &DeviceProfile::viscous_n_s_per_mm},
    {.name = "wall_along_n_per_mm",
     .least = 0,
     .most = kWallMaxNPerMm,
     .always = &DeviceProfile::wall_along_n_per_mm},
    {.name = "wall_across_n_per_mm",
     .least = 0,
     .most = kWallMaxNPerMm,
     .always = &DeviceProfile::wall_across_n_per_mm},
}};

/// Parses a number within its range; otherwise returns the error.
std::expected<double, std::string> number_of(std::string_view name, std::string_view text,
                                             double least, double most) {
  const auto value = to_number(text);
  if (value && *value >= least && *value <= most) return *value;
  std::ostringstream out;
  out << name << " must be a number from " << least << " to " << most;
  return std::unexpected(out.str());
}

/// Parses one line into the profile. Returns the error, or an empty string.
std::string take_line(DeviceProfile& profile, std::string_view line) {
  const std::size_t space = line.find(' ');
  const std::string_view name = line.substr(0, space);
  const std::string_view text = space == std::string_view::npos ? "" : trim(line.substr(space));
  if (name == "device") {
    profile.device = text;
    return {};
  }
  if (name == kLatency) {
    const auto value = number_of(name, text, 0, kLatencyMaxUs);
    if (!value) return value.error();
    profile.latency_us = static_cast<std::uint64_t>(*value);
    return {};
  }
  for (const Number& number : kNumbers) {
    if (number.name != name) continue;
    const auto value = number_of(name, text, number.least, number.most);
    if (!value) return value.error();
    if (number.always != nullptr) profile.*number.always = *value;
    if (number.optional != nullptr) profile.*number.optional = *value;
    return {};
  }
  return join({"unknown name '", name, "'"});
}

}  // namespace

std::string profile_mismatch(const DeviceProfile& profile, const DeviceCapabilities& device) {
  if (profile.device.empty() || profile.device == trim(device.name)) return {};
  return join({"the profile was measured on the ", profile.device, ", and this is the ",
               device.name,
               "; measure this device with kerf-agent doctor --identify FILE, or leave --profile "
               "out"});
}

DeviceCapabilities with_profile(DeviceCapabilities declared,
                                const std::optional<DeviceProfile>& profile) {
  if (!profile) return declared;
  const auto found = [](const std::optional<double>& value, double otherwise) {
    return value && *value > 0 ? *value : otherwise;
  };
  declared.latency_us = std::max(declared.latency_us, profile->latency_us.value_or(0));
  declared.resolution_mm = found(profile->resolution_mm, declared.resolution_mm);
  declared.resolution_rad = found(profile->resolution_rad, declared.resolution_rad);
  declared.moving_mass_kg = found(profile->moving_mass_kg, declared.moving_mass_kg);
  declared.moving_inertia_kg_m2 =
      found(profile->moving_inertia_kg_m2, declared.moving_inertia_kg_m2);
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
  if (profile.latency_us) file << kLatency << ' ' << *profile.latency_us << '\n';
  for (const Number& number : kNumbers) {
    const std::optional<double> value =
        number.always != nullptr ? profile.*number.always : profile.*number.optional;
    if (!value || (number.nonzero && *value == 0)) continue;
    file << number.name << ' ' << *value << '\n';
  }
  file.close();
  if (!file) return std::unexpected("cannot write " + path);
  return {};
}

}  // namespace kerf::agent
