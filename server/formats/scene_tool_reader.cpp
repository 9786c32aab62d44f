// SPDX-License-Identifier: Apache-2.0
#include "server/formats/scene_tool_reader.h"

#include <cmath>
#include <limits>

namespace kerf {
namespace {

TaperTip read_taper_tip(SceneFields& fields) {
  const std::string tip = fields.text("tip", "flat");
  if (tip == "flat") return TaperTip::kFlat;
  if (tip == "ball") return TaperTip::kBall;
  fields.reject("tip", "\"" + tip + "\" is not a tip shape; use flat or ball");
}

ArcBulge read_bulge(SceneFields& fields) {
  const std::string bulge = fields.text("bulge", "out");
  if (bulge == "out") return ArcBulge::kOut;
  if (bulge == "in") return ArcBulge::kIn;
  fields.reject("bulge", "\"" + bulge + "\" is not a bulge direction; use out or in");
}

ProfilePoint read_point(const SceneValue& value) {
  const auto [r, h] = value.numbers<2>();
  return {r, h};
}

// [r, h], {"to": [r, h], "radius": …, "bulge": …} or {"to": [r, h], "center": [r, h], "bulge": …}.
ProfileStep read_step(const SceneValue& value) {
  if (value.is_list()) return read_point(value);
  if (!value.is_object()) value.reject("must be a point [r, h] or an arc {\"to\": [r, h], …}");
  SceneFields fields(value);
  const ProfilePoint to = read_point(fields.required("to"));
  const ArcBulge bulge = read_bulge(fields);
  const auto radius = fields.find("radius"), center = fields.find("center");
  fields.reject_unknown();
  if (radius.has_value() == center.has_value())
    value.reject("must have either radius or center, and not both");
  if (radius) return ProfileArc{to, radius->number(0), bulge};
  return ProfileCenteredArc{to, read_point(*center), bulge};
}

// Sets `chords_follow` if the chord tolerance is missing. It is then the largest one until the
// scene's tolerance is known, so that no outline has too many pieces before.
ProfileShape read_profile(SceneFields& fields, bool& chords_follow) {
  ProfileShape shape;
  for (const SceneValue& step : fields.required("profile_mm").items()) {
    shape.steps.push_back(read_step(step));
  }
  chords_follow = !fields.find("chord_tolerance_mm");
  shape.chord_tolerance_mm = fields.positive("chord_tolerance_mm", kChordToleranceMaxMm);
  return shape;
}

AptShape read_apt(SceneFields& fields) {
  AptShape s{};
  s.d_mm = fields.positive("d_mm");
  s.r_mm = fields.number("r_mm");
  s.e_mm = fields.number("e_mm");
  s.f_mm = fields.number("f_mm");
  s.alpha_deg = fields.number("alpha_deg");
  s.beta_deg = fields.number("beta_deg");
  s.h_mm = fields.positive("h_mm");
  return s;
}

ToolShape read_shape(SceneFields& fields, bool& chords_follow) {
  const std::string shape = fields.text("shape");
  if (shape == "ball")
    return BallShape{fields.positive("diameter_mm"), fields.positive("length_mm")};
  if (shape == "flat")
    return FlatShape{fields.positive("diameter_mm"), fields.positive("length_mm")};
  if (shape == "bull_nose") {
    return BullNoseShape{fields.positive("diameter_mm"), fields.number("corner_radius_mm"),
                         fields.positive("length_mm")};
  }
  if (shape == "taper") {
    return TaperShape{fields.positive("diameter_mm"), fields.positive("half_angle_deg"),
                      fields.positive("length_mm"), read_taper_tip(fields)};
  }
  if (shape == "cone_end") {
    return ConeEndShape{fields.positive("diameter_mm"), fields.positive("tip_angle_deg"),
                        fields.positive("length_mm")};
  }
  if (shape == "apt") return read_apt(fields);
  if (shape == "profile") return read_profile(fields, chords_follow);
  fields.reject("shape", "\"" + shape +
                             "\" is not a tool shape; use ball, flat, bull_nose, taper, cone_end, "
                             "apt or profile");
}

HolderSection read_section(const SceneValue& value) {
  SceneFields fields(value);
  HolderSection section{};
  section.diameter_mm = fields.positive("diameter_mm");
  section.top_diameter_mm = fields.positive("top_diameter_mm", section.diameter_mm);
  section.length_mm = fields.positive("length_mm");
  fields.reject_unknown();
  return section;
}

ToolBody read_body(SceneFields& fields, bool& chords_follow) {
  ToolBody body;
  if (const auto value = fields.find("shank")) {
    SceneFields shank(*value);
    body.shank = Shank{shank.positive("diameter_mm"), shank.positive("length_mm")};
    shank.reject_unknown();
  }
  const auto value = fields.find("holder");
  if (!value) return body;
  if (value->is_list()) {
    std::vector<HolderSection> sections;
    for (const SceneValue& item : value->items()) sections.push_back(read_section(item));
    body.holder = std::move(sections);
    return body;
  }
  if (!value->is_object()) value->reject("must be a list of sections or an object with profile_mm");
  SceneFields holder(*value);
  body.holder = read_profile(holder, chords_follow);
  holder.reject_unknown();
  return body;
}

ToolId read_id(SceneFields& fields) {
  const double id = fields.positive("id");
  if (id != std::floor(id) || id > std::numeric_limits<ToolId>::max()) {
    fields.reject("id", "must be an integer from 1 to 4294967295");
  }
  return static_cast<ToolId>(id);
}

/// Reads all fields but the id.
SceneTool read_tool(SceneFields& fields) {
  bool chords = false, holder_chords = false;
  SceneTool tool{
      .shape = read_shape(fields, chords), .body = read_body(fields, holder_chords), .tool = {}};
  tool.chords_follow = chords;
  tool.holder_chords_follow = holder_chords;
  fields.reject_unknown();
  auto made = make_tool(tool.shape, tool.body);
  if (!made) fields.reject(made.error().field, made.error().reason);
  tool.tool = *std::move(made);
  return tool;
}

}  // namespace

SceneTool read_scene_tool(const SceneValue& value) {
  SceneFields fields(value);
  if (fields.find("id")) read_id(fields);
  return read_tool(fields);
}

void read_scene_tool(const SceneValue& value, std::map<ToolId, SceneTool>& tools) {
  SceneFields fields(value);
  const ToolId id = read_id(fields);
  if (tools.contains(id)) {
    fields.reject("id", "is " + std::to_string(id) + ", which is already the id of another tool");
  }
  tools.emplace(id, read_tool(fields));
}

}  // namespace kerf
