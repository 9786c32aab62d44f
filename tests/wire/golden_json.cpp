// SPDX-License-Identifier: Apache-2.0
#include "tests/wire/golden_json.h"

#include <array>
#include <cstdio>

namespace kerf::wire {
namespace {

using nlohmann::json;

json array_of(Vec3 v) { return {v.x, v.y, v.z}; }
json array_of(Vec3f v) { return array_of(Vec3(v)); }

json describe_body(const MotionBatch& batch) {
  json samples = json::array();
  for (const MotionSample& s : batch.view()) {
    samples.push_back({{"agent_sequence", s.agent_sequence},
                       {"time_us", s.time_us},
                       {"tip_mm", array_of(s.tip_mm)},
                       {"axis", array_of(s.axis)},
                       {"tool_id", s.tool_id},
                       {"buttons", s.buttons},
                       {"felt_share", static_cast<double>(s.felt_share)}});
  }
  return {{"samples", samples}};
}

json describe_planes(const Result& r) {
  json planes = json::array();
  for (const ContactPlane& p : r.contact()) {
    planes.push_back({{"point_mm", array_of(p.point_mm)},
                      {"normal", array_of(p.normal)},
                      {"depth_mm", static_cast<double>(p.depth_mm)},
                      {"stiffness_n_per_mm", static_cast<double>(p.stiffness_n_per_mm)},
                      {"radius_mm", static_cast<double>(p.radius_mm)},
                      {"flags", p.flags}});
  }
  return planes;
}

json describe_body(const Result& r) {
  return {{"agent_sequence", r.agent_sequence},
          {"agent_time_us", r.agent_time_us},
          {"motions_applied", r.motions_applied},
          {"force_n", array_of(r.force_n)},
          {"torque_nmm", array_of(r.torque_nmm)},
          {"engaged_area_mm2", static_cast<double>(r.engaged_area_mm2)},
          {"direction", array_of(r.direction)},
          {"cut_centre_mm", array_of(r.cut_centre_mm)},
          {"specific_force_n_per_mm2", static_cast<double>(r.specific_force_n_per_mm2)},
          {"removed_mm3", static_cast<double>(r.removed_mm3)},
          {"status", r.status},
          {"collision_force_n", array_of(r.collision_force_n)},
          {"turnaround_us", r.turnaround_us},
          {"planes", describe_planes(r)}};
}

json describe_body(const ToolStates& states) {
  json tools = json::array();
  for (const ToolState& t : states.tools) {
    tools.push_back({{"participant", t.participant},
                     {"tool_id", t.tool_id},
                     {"tip_mm", array_of(t.tip_mm)},
                     {"axis", array_of(t.axis)},
                     {"status", t.status},
                     {"force_n", array_of(t.force_n)},
                     {"torque_nmm", array_of(t.torque_nmm)},
                     {"removed_rate_mm3_per_s", static_cast<double>(t.removed_rate_mm3_per_s)},
                     {"felt_share", static_cast<double>(t.felt_share)}});
  }
  return {{"tools", tools}};
}

std::string hex_of(std::span<const std::byte> bytes) {
  std::string hex;
  for (const std::byte byte : bytes) {
    std::array<char, 3> digits{};
    std::snprintf(digits.data(), digits.size(), "%02x", std::to_integer<unsigned>(byte));
    hex += digits.data();
  }
  return hex;
}

json describe_body(const MeshView& mesh) { return {{"glb_hex", hex_of(mesh.glb)}}; }

json describe_body(const StockPatch& patch) {
  json tiles = json::array();
  for (const StockTile& tile : patch.tiles) {
    tiles.push_back(
        {{"axis", tile.axis}, {"x", tile.x}, {"y", tile.y}, {"columns_hex", hex_of(tile.columns)}});
  }
  return {{"reset", patch.reset},
          {"returned", patch.returned},
          {"agent_time_us", patch.agent_time_us},
          {"tiles", tiles}};
}

json describe_body(const Intents& intents) {
  json list = json::array();
  for (const Intent& t : intents.view()) {
    list.push_back({{"participant", t.participant},
                    {"tool_id", t.tool_id},
                    {"time_us", t.time_us},
                    {"agent_time_us", t.agent_time_us},
                    {"tip_mm", array_of(t.tip_mm)},
                    {"axis", array_of(t.axis)},
                    {"status", t.status}});
  }
  return {{"intents", list}};
}

json describe_body(const Ping& ping) { return {{"time_us", ping.time_us}}; }
json describe_body(const Pong& pong) {
  return {{"ping_time_us", pong.ping_time_us}, {"time_us", pong.time_us}};
}
json describe_body(const Ack&) { return json::object(); }
json describe_body(const UnknownBody&) { return json::object(); }

}  // namespace

json describe(const Message& message) {
  return std::visit([](const auto& body) { return describe_body(body); }, message.body);
}

std::string code_name(DecodeErrorCode code) {
  constexpr std::array kNames = {
      "too_short", "too_long",     "bad_magic",  "bad_header_bytes", "payload_mismatch",
      "bad_count", "bad_sequence", "not_finite", "axis_not_unit",    "bad_checksum"};
  return kNames.at(static_cast<std::size_t>(code));
}

}  // namespace kerf::wire
