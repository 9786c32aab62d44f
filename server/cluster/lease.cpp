// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/lease.h"

#include <nlohmann/json.hpp>
#include <utility>

namespace kerf {
namespace {

using Json = nlohmann::json;

constexpr std::string_view kSessionSubject = "kerf.cluster.session.";
constexpr std::string_view kNodeSubject = "kerf.cluster.node.";
constexpr std::pair<LeaseState, const char*> kStates[] = {{LeaseState::kHeld, "held"},
                                                          {LeaseState::kReleased, "released"},
                                                          {LeaseState::kClosed, "closed"}};

constexpr std::int64_t kNsPerMs = 1'000'000;
/// For a server that does not state it.
constexpr std::int64_t kDefaultMs = LeaseTime{}.writes_ns / kNsPerMs;

std::vector<std::byte> to_bytes(const Json& json) {
  const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

/// Calls `read` with the JSON object in the bytes. Nullopt if they are not an object, or a field
/// has another type.
template <typename Read>
auto from_bytes(std::span<const std::byte> bytes, Read read)
    -> std::optional<decltype(read(Json()))> {
  const auto* text = reinterpret_cast<const char*>(bytes.data());
  const Json json = Json::parse(text, text + bytes.size(), nullptr, false);
  if (!json.is_object()) return std::nullopt;
  try {
    return read(json);
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

std::optional<std::string> rest_of(std::string_view subject, std::string_view prefix) {
  if (!subject.starts_with(prefix) || subject.size() == prefix.size()) return std::nullopt;
  return std::string(subject.substr(prefix.size()));
}

}  // namespace

std::vector<std::byte> encode_lease(const Lease& lease) {
  const char* state = "closed";
  for (const auto& [value, name] : kStates) {
    if (value == lease.state) state = name;
  }
  return to_bytes({{"state", state},
                   {"node", lease.node},
                   {"run", lease.run},
                   {"address", lease.address},
                   {"epoch", lease.epoch},
                   {"lease_ms", lease.time.writes_ns / kNsPerMs},
                   {"to", lease.to},
                   {"name", lease.shown.name},
                   {"motions", lease.shown.motions},
                   {"removed_volume_mm3", lease.shown.removed_mm3},
                   {"participants", lease.shown.participants},
                   {"created_ms", lease.shown.created_ms},
                   {"active_ms", lease.shown.active_ms}});
}

std::optional<Lease> decode_lease(std::span<const std::byte> bytes) {
  const auto read = [](const Json& json) {
    Lease lease{.state = LeaseState::kClosed,
                .node = json.at("node"),
                .run = json.at("run"),
                .address = json.at("address"),
                .epoch = json.at("epoch"),
                .time = {json.value("lease_ms", kDefaultMs) * kNsPerMs},
                .to = json.value("to", ""),
                .shown = {.epoch = 0,
                          .name = json.value("name", ""),
                          .motions = json.value("motions", std::uint64_t{0}),
                          .removed_mm3 = json.value("removed_volume_mm3", 0.0),
                          .participants = json.value("participants", std::size_t{0}),
                          .created_ms = json.value("created_ms", std::int64_t{0}),
                          .active_ms = json.value("active_ms", std::int64_t{0})}};
    for (const auto& [value, name] : kStates) {
      if (json.at("state") == name) lease.state = value;
    }
    return lease;
  };
  return from_bytes(bytes, read);
}

std::vector<std::byte> encode_node(const NodeNote& note) {
  return to_bytes(
      {{"run", note.run}, {"address", note.address}, {"only_follows", note.only_follows}});
}

std::optional<NodeNote> decode_node(std::span<const std::byte> bytes) {
  return from_bytes(bytes, [](const Json& json) {
    return NodeNote{json.at("run"), json.at("address"), json.value("only_follows", false)};
  });
}

std::string lease_subject(const std::string& session) {
  return std::string(kSessionSubject) + session;
}
std::string node_subject(const std::string& node) { return std::string(kNodeSubject) + node; }
std::optional<std::string> session_of_subject(std::string_view subject) {
  return rest_of(subject, kSessionSubject);
}
std::optional<std::string> node_of_subject(std::string_view subject) {
  return rest_of(subject, kNodeSubject);
}

}  // namespace kerf
