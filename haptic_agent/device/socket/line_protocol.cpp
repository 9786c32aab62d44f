// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/socket/line_protocol.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>

#include "haptic_agent/device/plugin/c_structs.h"
#include "haptic_agent/device/text_fields.h"

namespace kerf::agent {
namespace {

/// Removes the first word, up to a space, and returns it. Empty at the end.
std::string_view take_word(std::string_view& line) noexcept {
  const std::size_t end = std::min(line.find(' '), line.size());
  const std::string_view word = line.substr(0, end);
  line.remove_prefix(std::min(end + 1, line.size()));
  return word;
}

template <typename Integer>
bool read_integer(std::string_view word, Integer& value) noexcept {
  const auto [end, failed] = std::from_chars(word.data(), word.data() + word.size(), value);
  return failed == std::errc{} && end == word.data() + word.size() && !word.empty();
}

bool read_number(std::string_view word, double& value) noexcept {
  const auto number = to_number(word);
  if (number) value = *number;
  return number.has_value();
}

bool read_vector(std::string_view word, double (&vector)[3]) {
  const auto fields = split_fields(word);
  return fields.size() == 3 && read_number(fields[0], vector[0]) &&
         read_number(fields[1], vector[1]) && read_number(fields[2], vector[2]);
}

struct NumberKey {
  std::string_view key;
  double kerf_agent_capabilities::* field;
};

constexpr NumberKey kNumberKeys[] = {
    {"max_force_n", &kerf_agent_capabilities::max_force_n},
    {"max_torque_nmm", &kerf_agent_capabilities::max_torque_nmm},
    {"continuous_force_n", &kerf_agent_capabilities::continuous_force_n},
    {"continuous_torque_nmm", &kerf_agent_capabilities::continuous_torque_nmm},
    {"max_stiffness_n_per_mm", &kerf_agent_capabilities::max_stiffness_n_per_mm},
    {"max_damping_n_s_per_mm", &kerf_agent_capabilities::max_damping_n_s_per_mm},
    {"moving_mass_kg", &kerf_agent_capabilities::moving_mass_kg},
    {"moving_inertia_kg_m2", &kerf_agent_capabilities::moving_inertia_kg_m2},
    {"resolution_mm", &kerf_agent_capabilities::resolution_mm},
    {"resolution_rad", &kerf_agent_capabilities::resolution_rad},
};

struct IntegerKey {
  std::string_view key;
  std::uint32_t kerf_agent_capabilities::* field;
};

constexpr IntegerKey kIntegerKeys[] = {
    {"sensed_dof", &kerf_agent_capabilities::sensed_dof},
    {"actuated_dof", &kerf_agent_capabilities::actuated_dof},
    {"latency_us", &kerf_agent_capabilities::latency_us},
    {"max_vibration_hz", &kerf_agent_capabilities::max_vibration_hz},
};

struct FlagKey {
  std::string_view key;
  std::uint32_t flag;
};

constexpr FlagKey kFlagKeys[] = {{"deadman", KERF_AGENT_HAS_DEADMAN},
                                 {"always_cut", KERF_AGENT_ALWAYS_CUT}};

/// Reads one KEY=VALUE. Returns false if the key is unknown or the value malformed.
bool read_key(std::string_view key, std::string_view value, kerf_agent_capabilities& given) {
  for (const NumberKey& known : kNumberKeys) {
    if (key == known.key) return read_number(value, given.*known.field);
  }
  for (const IntegerKey& known : kIntegerKeys) {
    if (key == known.key) return read_integer(value, given.*known.field);
  }
  for (const FlagKey& known : kFlagKeys) {
    if (key != known.key) continue;
    if (value != "0" && value != "1") return false;
    given.flags = value == "1" ? given.flags | known.flag : given.flags & ~known.flag;
    return true;
  }
  if (key == "workspace_min_mm") return read_vector(value, given.workspace_min_mm);
  if (key == "workspace_max_mm") return read_vector(value, given.workspace_max_mm);
  return false;
}

std::optional<std::uint32_t> state_named(std::string_view word) noexcept {
  constexpr std::string_view kNames[] = {"absent", "fault", "homing", "ready", "finished"};
  const auto* const found = std::ranges::find(kNames, word);
  if (found == std::end(kNames)) return std::nullopt;
  return static_cast<std::uint32_t>(found - std::begin(kNames));
}

}  // namespace

std::expected<DeviceCapabilities, std::string> parse_device_line(std::string_view line) {
  if (take_word(line) != "kerf-device")
    return std::unexpected("it does not begin with kerf-device");
  if (const auto version = take_word(line); version != "1") {
    return std::unexpected(join({"it uses version ", version, " of the protocol, not 1"}));
  }
  kerf_agent_capabilities given{};
  std::string name = "device";
  while (!line.empty()) {
    const std::string_view word = take_word(line);
    const std::size_t equals = word.find('=');
    const std::string_view value =
        equals == word.npos ? std::string_view{} : word.substr(equals + 1);
    if (word.starts_with("name=")) {
      name = value;
    } else if (equals == word.npos || !read_key(word.substr(0, equals), value, given)) {
      return std::unexpected(join({"'", word, "' is not a known KEY=VALUE"}));
    }
  }
  given.name = name.c_str();
  return capabilities_of(given);
}

std::optional<SocketPose> parse_pose_line(std::string_view line, bool has_deadman,
                                          std::uint64_t now_us) noexcept {
  if (take_word(line) != "pose") return std::nullopt;
  kerf_agent_pose pose{};
  SocketPose parsed;
  const auto state = state_named(take_word(line));
  if (!state) return std::nullopt;
  pose.state = *state;
  for (double& number : pose.tip_mm) {
    if (!read_number(take_word(line), number)) return std::nullopt;
  }
  for (double& number : pose.axis) {
    if (!read_number(take_word(line), number)) return std::nullopt;
  }
  if (!read_integer(take_word(line), pose.buttons)) return std::nullopt;
  if (!read_integer(take_word(line), parsed.accepted) || !line.empty()) return std::nullopt;
  parsed.state = state_of(pose, has_deadman, now_us);
  return parsed;
}

std::string session_line(const StockBox& stock, double pivot_mm, std::uint32_t participant) {
  std::array<char, 256> line{};
  const int bytes =
      std::snprintf(line.data(), line.size(), "session %u %.9g %.9g %.9g %.9g %.9g %.9g %.9g\n",
                    participant, pivot_mm, stock.min_mm.x, stock.min_mm.y, stock.min_mm.z,
                    stock.max_mm.x, stock.max_mm.y, stock.max_mm.z);
  return {line.data(), static_cast<std::size_t>(bytes)};
}

std::string_view write_wrench_line(std::span<char, 256> line, std::uint16_t number,
                                   const Wrench& wrench) noexcept {
  const Vec3 f = wrench.force_n, t = wrench.torque_nmm;
  const int bytes =
      std::snprintf(line.data(), line.size(), "wrench %u %.6g %.6g %.6g %.6g %.6g %.6g\n",
                    static_cast<unsigned>(number), f.x, f.y, f.z, t.x, t.y, t.z);
  return {line.data(), static_cast<std::size_t>(bytes)};
}

}  // namespace kerf::agent
