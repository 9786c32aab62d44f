// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "server/formats/guide_json.h"
#include "server/formats/scene.h"

namespace kerf {
namespace {

// Ordered, so that fields of the canonical text keep the order in which they are inserted.
using OrderedJson = nlohmann::ordered_json;

template <class... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};
template <class... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

OrderedJson to_json(Vec3 v) { return OrderedJson::array({v.x, v.y, v.z}); }

OrderedJson to_json(const StockShape& stock) {
  return std::visit(
      Overloaded{
          [](const BoxStock& box) {
            return OrderedJson{
                {"shape", "box"}, {"min_mm", to_json(box.min_mm)}, {"max_mm", to_json(box.max_mm)}};
          },
          [](const CylinderStock& c) {
            return OrderedJson{{"shape", "cylinder"},
                               {"center_mm", OrderedJson::array({c.center_x_mm, c.center_y_mm})},
                               {"radius_mm", c.radius_mm},
                               {"min_z_mm", c.min_z_mm},
                               {"max_z_mm", c.max_z_mm}};
          }},
      stock);
}

OrderedJson to_json(const ProfilePoint& point) {
  return OrderedJson::array({point.r_mm, point.h_mm});
}

OrderedJson to_json(const ProfileStep& step) {
  const auto side = [](ArcBulge bulge) { return bulge == ArcBulge::kOut ? "out" : "in"; };
  return std::visit(Overloaded{[](const ProfilePoint& point) { return to_json(point); },
                               [&](const ProfileArc& arc) {
                                 return OrderedJson{{"to", to_json(arc.to)},
                                                    {"radius", arc.radius_mm},
                                                    {"bulge", side(arc.bulge)}};
                               },
                               [&](const ProfileCenteredArc& arc) {
                                 return OrderedJson{{"to", to_json(arc.to)},
                                                    {"center", to_json(arc.center)},
                                                    {"bulge", side(arc.bulge)}};
                               }},
                    step);
}

OrderedJson to_json(const ProfileShape& profile) {
  OrderedJson steps = OrderedJson::array();
  for (const ProfileStep& step : profile.steps) steps.push_back(to_json(step));
  return {{"profile_mm", steps}, {"chord_tolerance_mm", profile.chord_tolerance_mm}};
}

OrderedJson to_json(ToolId id, const ToolShape& shape) {
  OrderedJson json{{"id", id}};
  std::visit(Overloaded{[&](const BallShape& s) {
                          json.update({{"shape", "ball"},
                                       {"diameter_mm", s.diameter_mm},
                                       {"length_mm", s.length_mm}});
                        },
                        [&](const FlatShape& s) {
                          json.update({{"shape", "flat"},
                                       {"diameter_mm", s.diameter_mm},
                                       {"length_mm", s.length_mm}});
                        },
                        [&](const TaperShape& s) {
                          json.update({{"shape", "taper"},
                                       {"diameter_mm", s.diameter_mm},
                                       {"half_angle_deg", s.half_angle_deg},
                                       {"length_mm", s.length_mm},
                                       {"tip", s.tip == TaperTip::kBall ? "ball" : "flat"}});
                        },
                        [&](const ConeEndShape& s) {
                          json.update({{"shape", "cone_end"},
                                       {"diameter_mm", s.diameter_mm},
                                       {"tip_angle_deg", s.tip_angle_deg},
                                       {"length_mm", s.length_mm}});
                        },
                        [&](const BullNoseShape& s) {
                          json.update({{"shape", "bull_nose"},
                                       {"diameter_mm", s.diameter_mm},
                                       {"corner_radius_mm", s.corner_radius_mm},
                                       {"length_mm", s.length_mm}});
                        },
                        [&](const AptShape& s) {
                          json.update({{"shape", "apt"},
                                       {"d_mm", s.d_mm},
                                       {"r_mm", s.r_mm},
                                       {"e_mm", s.e_mm},
                                       {"f_mm", s.f_mm},
                                       {"alpha_deg", s.alpha_deg},
                                       {"beta_deg", s.beta_deg},
                                       {"h_mm", s.h_mm}});
                        },
                        [&](const ProfileShape& s) {
                          json["shape"] = "profile";
                          json.update(to_json(s));
                        }},
             shape);
  return json;
}

OrderedJson to_json(const Holder& holder) {
  if (const auto* profile = std::get_if<ProfileShape>(&holder)) return to_json(*profile);
  OrderedJson sections = OrderedJson::array();
  for (const HolderSection& s : std::get<std::vector<HolderSection>>(holder)) {
    sections.push_back({{"diameter_mm", s.diameter_mm},
                        {"top_diameter_mm", s.top_diameter_mm},
                        {"length_mm", s.length_mm}});
  }
  return sections;
}

OrderedJson to_json(ToolId id, const SceneTool& tool) {
  OrderedJson json = to_json(id, tool.shape);
  if (tool.body.shank) {
    json["shank"] = {{"diameter_mm", tool.body.shank->diameter_mm},
                     {"length_mm", tool.body.shank->length_mm}};
  }
  if (tool.body.holder) json["holder"] = to_json(*tool.body.holder);
  return json;
}

OrderedJson tools_to_json(const Scene& scene) {
  OrderedJson tools = OrderedJson::array();
  for (const auto& [id, tool] : scene.tools) tools.push_back(to_json(id, tool));
  return tools;
}

OrderedJson to_json(const ForceSettings& force) {
  OrderedJson json = {{"law", to_string(force.law)},
                      {"specific_force_n_per_mm2", force.specific_force_n_per_mm2},
                      {"drr_n_s_per_mm3", force.drr_n_s_per_mm3},
                      {"pivot_mm", force.pivot_mm},
                      {"contact_stiffness_n_per_mm", force.contact_stiffness_n_per_mm}};
  if (force.law != ForceLaw::kMechanistic) return json;
  const MillingSettings& m = force.milling;
  json["spindle_rpm"] = m.spindle_rpm;
  json["teeth"] = m.teeth;
  json["helix_deg"] = m.helix_deg;
  json["feed_per_tooth_mm"] = m.feed_per_tooth_mm;
  json["runout_mm"] = m.runout_mm;
  json["ripple_hz"] = m.ripple_hz;
  json["scale"] = m.scale;
  json["tangential_n_per_mm2"] = m.cut_n_per_mm2.tangential;
  json["radial_n_per_mm2"] = m.cut_n_per_mm2.radial;
  json["axial_n_per_mm2"] = m.cut_n_per_mm2.axial;
  json["tangential_edge_n_per_mm"] = m.edge_n_per_mm.tangential;
  json["radial_edge_n_per_mm"] = m.edge_n_per_mm.radial;
  json["axial_edge_n_per_mm"] = m.edge_n_per_mm.axial;
  const EdgeCoefficients& exponents = m.chip_exponents;
  if (exponents == in_all_directions(exponents.tangential)) {
    json["chip_exponent"] = exponents.tangential;
    return json;
  }
  json["tangential_chip_exponent"] = exponents.tangential;
  json["radial_chip_exponent"] = exponents.radial;
  json["axial_chip_exponent"] = exponents.axial;
  return json;
}

const char* unit_name(double unit_mm) {
  if (unit_mm == 1) return "mm";
  if (unit_mm == 10) return "cm";
  return unit_mm == 1000 ? "m" : "inch";
}

// Default values are omitted, as in scenes from before these fields existed.
OrderedJson to_json(const MeshFile& file) {
  OrderedJson json{{"shape", "mesh"}, {"file", file.file}};
  if (file.repair) json["repair"] = true;
  const MeshPlacement standard;
  OrderedJson placement = OrderedJson::object();
  if (file.unit_mm) placement["unit"] = unit_name(*file.unit_mm);
  if (file.placement.scale != standard.scale) placement["scale"] = to_json(file.placement.scale);
  if (file.placement.rotate_deg != standard.rotate_deg)
    placement["rotate_deg"] = to_json(file.placement.rotate_deg);
  if (file.placement.translate_mm != standard.translate_mm)
    placement["translate_mm"] = to_json(file.placement.translate_mm);
  if (!placement.empty()) json["placement"] = placement;
  return json;
}

OrderedJson to_json(const Obstacle& obstacle, const MeshFile& file) {
  OrderedJson json = std::visit(Overloaded{[](const BoxObstacle& box) {
                                             return OrderedJson{{"shape", "box"},
                                                                {"min_mm", to_json(box.min_mm)},
                                                                {"max_mm", to_json(box.max_mm)}};
                                           },
                                           [](const CylinderObstacle& c) {
                                             return OrderedJson{{"shape", "cylinder"},
                                                                {"from_mm", to_json(c.from_mm)},
                                                                {"to_mm", to_json(c.to_mm)},
                                                                {"radius_mm", c.radius_mm}};
                                           },
                                           [](const SphereObstacle& s) {
                                             return OrderedJson{{"shape", "sphere"},
                                                                {"center_mm", to_json(s.center_mm)},
                                                                {"radius_mm", s.radius_mm}};
                                           },
                                           [&file](const MeshObstacle&) { return to_json(file); }},
                                obstacle.shape);
  json["stiffness_n_per_mm"] = obstacle.stiffness_n_per_mm;
  return json;
}

// A target is written together with the values chosen for it. Reading it back then chooses nothing,
// so a journal keeps its values even if a later version would choose others.
OrderedJson accuracy_to_json(const Scene& scene) {
  const SculptureSettings& s = scene.settings;
  OrderedJson json = OrderedJson::object();
  if (scene.accuracy) json["target_mm"] = scene.accuracy->request.target_mm;
  json.update({{"rays", to_string(s.rays)},
               {"pitch_mm", s.pitch_mm},
               {"tolerance_mm", s.tolerance_mm},
               {"motion", s.motion == MotionModel::kTight ? "tight" : "paper"}});
  return json;
}

// Replaces invalid UTF-8, which can only come from code, because the parser rejects it in files.
std::string text_of(const OrderedJson& json) {
  return json.dump(-1, ' ', false, OrderedJson::error_handler_t::replace);
}

}  // namespace

/// The fields of the machine. Those added after the first release are absent at their defaults, so
/// the canonical text of earlier scenes does not change.
OrderedJson to_json(const Machine& machine) {
  const Machine standard;
  OrderedJson json = {{"kinematics", to_string(machine.kinematics)},
                      {"rapid_mm_per_min", machine.rapid_mm_per_min}};
  if (machine.dialect != Dialect::kAuto) json["dialect"] = std::string(name_of(machine.dialect));
  if (machine.rotary_direction == RotaryDirection::kTool) json["rotary_direction"] = "tool";
  if (machine.spindle_tool > 0) json["spindle_tool"] = machine.spindle_tool;
  if (machine.feed_max_mm_per_min) {
    json["feed_max_mm_per_min"] = to_json(*machine.feed_max_mm_per_min);
  }
  if (machine.acceleration_mm_per_s2 != standard.acceleration_mm_per_s2) {
    json["acceleration_mm_per_s2"] = to_json(machine.acceleration_mm_per_s2);
  }
  if (machine.turn_max_rad_per_s != standard.turn_max_rad_per_s) {
    json["turn_max_rad_per_s"] = machine.turn_max_rad_per_s;
  }
  if (machine.turn_acceleration_rad_per_s2 != standard.turn_acceleration_rad_per_s2) {
    json["turn_acceleration_rad_per_s2"] = machine.turn_acceleration_rad_per_s2;
  }
  return json;
}

std::string scene_json(const Scene& scene) {
  const SculptureSettings& settings = scene.settings;
  const OrderedJson stock =
      scene.stock_file.file.empty() ? to_json(settings.stock) : to_json(scene.stock_file);
  OrderedJson obstacles = OrderedJson::array();
  for (std::size_t i = 0; i < settings.obstacles.size(); ++i)
    obstacles.push_back(to_json(settings.obstacles[i], scene.obstacle_files[i]));
  OrderedJson json = {{"name", scene.name},
                      {"stock", stock},
                      {"accuracy", accuracy_to_json(scene)},
                      {"tools", tools_to_json(scene)},
                      {"force", to_json(settings.force)},
                      {"machine", to_json(scene.machine)},
                      {"obstacles", obstacles}};
  if (!scene.guides.empty())
    json["guides"] = OrderedJson::parse(guides_json(scene.guides, GuideFiles::kNamed));
  return text_of(json);
}

std::string stock_json(const Scene& scene) { return text_of(to_json(scene.settings.stock)); }
std::string tool_json(ToolId id, const SceneTool& tool) { return text_of(to_json(id, tool)); }
std::string tools_json(const Scene& scene) { return text_of(tools_to_json(scene)); }
std::string accuracy_json(const Scene& scene) {
  OrderedJson json = accuracy_to_json(scene);
  if (scene.accuracy) {
    json["predicted_error_mm"] = scene.accuracy->predicted_error_mm;
    json["reason"] = scene.accuracy->reason;
  }
  return text_of(json);
}
std::string force_json(const Scene& scene) { return text_of(to_json(scene.settings.force)); }

}  // namespace kerf
