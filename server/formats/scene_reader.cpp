// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "kernel/dexel/mesh_stock.h"
#include "server/formats/bounded_json.h"
#include "server/formats/guide_paths.h"
#include "server/formats/guide_reader.h"
#include "server/formats/json_location.h"
#include "server/formats/scene.h"
#include "server/formats/scene_fields.h"
#include "server/formats/scene_force_reader.h"
#include "server/formats/scene_tool_reader.h"
#include "server/formats/text_file.h"
#include "server/formats/units.h"

namespace kerf {
namespace {

using Json = nlohmann::json;

// Limits for hostile input; far above any real scene.
constexpr std::size_t kSceneBytesMax = std::size_t{1} << 20;
constexpr int kSceneDepthMax = 32;

void check_box(SceneFields& fields, Vec3 min, Vec3 max) {
  if (!(min.x < max.x && min.y < max.y && min.z < max.z))
    fields.reject("max_mm", "must be greater than min_mm in every coordinate");
}

std::string read_scene_file(SceneFields& fields, const std::string& name, const SceneSource& source,
                            Scene& scene) {
  const auto kept = source.files.find(name);
  if (kept == source.files.end() && !source.base_folder)
    fields.reject("file", "may not name a file: the scene was not loaded from a folder");
  auto bytes = kept != source.files.end() ? std::optional(kept->second)
                                          : read_file(*source.base_folder / name);
  if (!bytes) fields.reject("file", "\"" + name + "\" cannot be read");
  if (source.keep_files) scene.files[name] = *bytes;
  return *std::move(bytes);
}

MeshFile read_mesh_file(SceneFields& fields) {
  MeshFile file;
  file.file = fields.text("file");
  if (const auto repair = fields.find("repair")) file.repair = repair->flag();
  const auto value = fields.find("placement");
  if (!value) return file;
  SceneFields placement(*value);
  if (placement.find("unit")) {
    file.unit_mm = mm_of_unit(placement.text("unit"));
    if (!file.unit_mm) placement.reject("unit", "must be mm, cm, m or inch");
  }
  if (placement.find("scale")) {
    file.placement.scale = placement.vec3("scale");
    const Vec3 scale = file.placement.scale;
    if (!(scale.x > 0 && scale.y > 0 && scale.z > 0))
      placement.reject("scale", "must be three numbers above 0");
  }
  if (placement.find("rotate_deg")) {
    file.placement.rotate_deg = placement.vec3("rotate_deg");
    const Vec3 turn = file.placement.rotate_deg;
    if (!(std::abs(turn.x) <= 360 && std::abs(turn.y) <= 360 && std::abs(turn.z) <= 360))
      placement.reject("rotate_deg", "must be three angles within 360 degrees");
  }
  if (placement.find("translate_mm")) file.placement.translate_mm = placement.vec3("translate_mm");
  placement.reject_unknown();
  return file;
}

LoadedMesh read_scene_mesh(SceneFields& fields, const MeshFile& file, const SceneSource& source,
                           Scene& scene) {
  const std::string bytes = read_scene_file(fields, file.file, source, scene);
  if (source.load_mesh == nullptr) fields.reject("file", "may not name a mesh here");
  auto loaded = source.load_mesh(file, std::as_bytes(std::span(bytes)), source.stop);
  if (!loaded) fields.reject("file", "\"" + file.file + "\": " + loaded.error());
  return *std::move(loaded);
}

void read_mesh_stock(SceneFields& fields, const SceneSource& source, Scene& scene) {
  scene.stock_file = read_mesh_file(fields);
  LoadedMesh loaded = read_scene_mesh(fields, scene.stock_file, source, scene);
  const std::string fault = mesh_stock_fault(loaded.mesh);
  if (!fault.empty())
    fields.reject("file", "\"" + scene.stock_file.file + "\": " + fault +
                              "; \"repair\": true closes holes and orients triangles");
  scene.stock_repair = loaded.repair;
  scene.settings.stock = mesh_bounds(loaded.mesh);
  scene.settings.stock_mesh = std::make_shared<const TriangleMesh>(std::move(loaded.mesh));
}

void read_stock(const SceneValue& value, const SceneSource& source, Scene& scene) {
  SceneFields fields(value);
  const std::string shape = fields.text("shape");
  if (shape == "box") {
    const BoxStock box{fields.vec3("min_mm"), fields.vec3("max_mm")};
    check_box(fields, box.min_mm, box.max_mm);
    scene.settings.stock = box;
  } else if (shape == "cylinder") {
    const auto center = fields.numbers<2>("center_mm");
    const CylinderStock cylinder{center[0], center[1], fields.positive("radius_mm"),
                                 fields.number("min_z_mm"), fields.number("max_z_mm")};
    if (!(cylinder.min_z_mm < cylinder.max_z_mm))
      fields.reject("max_z_mm", "must be greater than min_z_mm");
    scene.settings.stock = cylinder;
  } else if (shape == "stl" || shape == "mesh") {
    read_mesh_stock(fields, source, scene);
  } else {
    fields.reject("shape", "\"" + shape + "\" is not a stock shape; use box, cylinder or mesh");
  }
  fields.reject_unknown();
}

MotionModel read_motion(SceneFields& accuracy) {
  const std::string motion = accuracy.text("motion");
  if (motion == "tight") return MotionModel::kTight;
  if (motion == "paper") return MotionModel::kPaper;
  accuracy.reject("motion", "\"" + motion + "\" is not a motion model; use tight or paper");
}

Rays read_rays(SceneFields& accuracy) {
  const std::string rays = accuracy.text("rays");
  if (rays == "dexel") return Rays::kDexel;
  if (rays == "tri-dexel") return Rays::kTriDexel;
  accuracy.reject("rays", "\"" + rays + "\" is not a ray model; use dexel or tri-dexel");
}

// Missing values are chosen if there is a target, and have their defaults otherwise.
AccuracyRequest read_accuracy(const SceneValue& value) {
  SceneFields fields(value);
  AccuracyRequest request;
  if (fields.find("target_mm")) request.target_mm = fields.positive("target_mm");
  if (fields.find("rays")) request.rays = read_rays(fields);
  if (fields.find("pitch_mm")) request.pitch_mm = fields.positive("pitch_mm");
  if (fields.find("tolerance_mm")) request.tolerance_mm = fields.positive("tolerance_mm");
  if (fields.find("motion")) request.motion = read_motion(fields);
  fields.reject_unknown();
  return request;
}

// Tools and machine must have been read before, because the choice depends on the largest radii of
// the tools. Fillets, whose chords depend on the tolerance, do not change these.
void apply_accuracy(const AccuracyRequest& request, Scene& scene) {
  if (request.target_mm > 0) {
    if (auto resolved = resolve_accuracy(scene, request); !resolved)
      throw SceneRejection{"accuracy." + resolved.error().field, resolved.error().reason};
    return;
  }
  SculptureSettings& settings = scene.settings;
  settings.rays = request.rays.value_or(settings.rays);
  settings.pitch_mm = request.pitch_mm.value_or(settings.pitch_mm);
  settings.tolerance_mm = request.tolerance_mm.value_or(settings.tolerance_mm);
  settings.motion = request.motion.value_or(settings.motion);
}

ToolId read_spindle_tool(SceneFields& fields, const std::map<ToolId, SceneTool>& tools) {
  if (!fields.find("spindle_tool")) return 0;
  const double id = fields.positive("spindle_tool");
  if (id != std::floor(id) || id > std::numeric_limits<ToolId>::max() ||
      !tools.contains(static_cast<ToolId>(id)))
    fields.reject("spindle_tool", "is not the id of a tool of the scene");
  return static_cast<ToolId>(id);
}

/// A value > 0 for each linear axis.
std::optional<Vec3> read_axes(SceneFields& fields, const std::string& field) {
  const auto value = fields.find(field);
  if (!value) return std::nullopt;
  const auto [x, y, z] = value->numbers<3>();
  if (!(x > 0) || !(y > 0) || !(z > 0)) fields.reject(field, "must be above 0 on each axis");
  return Vec3{x, y, z};
}

void read_dynamics(SceneFields& fields, Machine& machine) {
  machine.feed_max_mm_per_min = read_axes(fields, "feed_max_mm_per_min");
  machine.acceleration_mm_per_s2 =
      read_axes(fields, "acceleration_mm_per_s2").value_or(machine.acceleration_mm_per_s2);
  machine.turn_max_rad_per_s = fields.positive("turn_max_rad_per_s", machine.turn_max_rad_per_s);
  machine.turn_acceleration_rad_per_s2 =
      fields.positive("turn_acceleration_rad_per_s2", machine.turn_acceleration_rad_per_s2);
}

Machine read_machine(const SceneValue& value, const std::map<ToolId, SceneTool>& tools) {
  SceneFields fields(value);
  Machine machine;
  const std::string kinematics = fields.text("kinematics", to_string(machine.kinematics));
  bool known = false;
  for (const auto kind : {MachineKinematics::kXyz, MachineKinematics::kXyzacTrt,
                          MachineKinematics::kXyzbcTrt, MachineKinematics::kToolVector}) {
    if (kinematics != to_string(kind)) continue;
    machine.kinematics = kind;
    known = true;
  }
  if (!known)
    fields.reject(
        "kinematics",
        "\"" + kinematics + "\" is not supported; use xyz, xyzac-trt, xyzbc-trt or tool-vector");
  machine.rapid_mm_per_min = fields.positive("rapid_mm_per_min", machine.rapid_mm_per_min);
  read_dynamics(fields, machine);
  const std::string dialect = fields.text("dialect", "auto");
  if (const auto named = dialect_of(dialect))
    machine.dialect = *named;
  else
    fields.reject("dialect", "\"" + dialect + "\" is not known; use one of " + dialect_names());
  const std::string rotary = fields.text("rotary_direction", "table");
  if (rotary != "table" && rotary != "tool")
    fields.reject("rotary_direction", "\"" + rotary + "\" is not a direction; use table or tool");
  if (rotary == "tool") machine.rotary_direction = RotaryDirection::kTool;
  machine.spindle_tool = read_spindle_tool(fields, tools);
  fields.reject_unknown();
  return machine;
}

MeshObstacle read_mesh_obstacle(SceneFields& fields, const MeshFile& file,
                                const SceneSource& source, Scene& scene) {
  const TriangleMesh mesh = read_scene_mesh(fields, file, source, scene).mesh;
  MeshObstacle obstacle;
  for (const auto& t : mesh.triangles)
    obstacle.triangles.push_back(
        {mesh.vertices_mm[t[0]], mesh.vertices_mm[t[1]], mesh.vertices_mm[t[2]]});
  return obstacle;
}

void read_obstacle(const SceneValue& value, const SceneSource& source, Scene& scene) {
  SceneFields fields(value);
  const std::string shape = fields.text("shape");
  Obstacle obstacle;
  MeshFile file;
  if (shape == "box") {
    const BoxObstacle box{fields.vec3("min_mm"), fields.vec3("max_mm")};
    check_box(fields, box.min_mm, box.max_mm);
    obstacle.shape = box;
  } else if (shape == "cylinder") {
    const CylinderObstacle cylinder{fields.vec3("from_mm"), fields.vec3("to_mm"),
                                    fields.positive("radius_mm")};
    if (cylinder.from_mm == cylinder.to_mm) fields.reject("to_mm", "must differ from from_mm");
    obstacle.shape = cylinder;
  } else if (shape == "sphere") {
    obstacle.shape = SphereObstacle{fields.vec3("center_mm"), fields.positive("radius_mm")};
  } else if (shape == "stl" || shape == "mesh") {
    file = read_mesh_file(fields);
    obstacle.shape = read_mesh_obstacle(fields, file, source, scene);
  } else {
    fields.reject("shape",
                  "\"" + shape + "\" is not an obstacle shape; use box, cylinder, sphere or mesh");
  }
  obstacle.stiffness_n_per_mm = fields.positive("stiffness_n_per_mm", obstacle.stiffness_n_per_mm);
  fields.reject_unknown();
  scene.settings.obstacles.push_back(std::move(obstacle));
  scene.obstacle_files.push_back(std::move(file));
}

/// Share of a guide's allowed distance within which its path is joined and its strokes thinned.
constexpr double kGuideJoinShare = 0.05;

std::vector<GuidePath> read_guide_file(SceneFields& fields, const PathGuide& guide,
                                       const SceneSource& source, Scene& scene) {
  const std::string bytes = read_scene_file(fields, guide.file, source, scene);
  const double apart_mm = kGuideJoinShare * guide.within_mm;
  auto paths = guide.stroke ? strokes_of_forces(bytes, apart_mm)
                            : paths_of_program(guide.file, bytes, scene, apart_mm);
  if (!paths) fields.reject("file", "\"" + guide.file + "\": " + paths.error());
  return *std::move(paths);
}

// The surface of the stock, for guides that name no surface.
SnapSurface stock_surface(const Scene& scene, const SceneValue& guides) {
  if (scene.settings.stock_mesh)
    guides.reject("snap to a box or cylinder only: state a \"surface\" beside the mesh stock");
  const BoxStock box = stock_bounds(scene.settings.stock);
  return {std::holds_alternative<CylinderStock>(scene.settings.stock), box.min_mm, box.max_mm};
}

// Call last: programs depend on tools, machine and tolerance.
void read_scene_guides(const SceneValue& list, const SceneSource& source, Scene& scene) {
  scene.guides = read_guides(list, [&](SceneFields& fields, const PathGuide& guide) {
    return read_guide_file(fields, guide, source, scene);
  });
  for (Guide& guide : scene.guides) {
    auto* snap = std::get_if<SnapGuide>(&guide.shape);
    if (snap != nullptr && !snap->surface) snap->surface = stock_surface(scene, list);
  }
}

// `tools` are the items from which scene.tools was read.
void apply_tolerance_to_tools(const std::vector<SceneValue>& tools, Scene& scene) {
  const auto resolved = resolve_chords(scene);
  if (resolved) return;
  for (const SceneValue& item : tools) {
    SceneFields fields(item);
    if (fields.positive("id") == resolved.error().tool)
      fields.reject(resolved.error().error.field, resolved.error().error.reason);
  }
}

Scene read_scene(const Json& json, const SceneSource& source) {
  SceneFields fields(SceneValue(&json, ""));
  Scene scene;
  if (const auto schema = fields.find("$schema")) schema->text();  // for editors only
  scene.name = fields.text("name", "untitled");
  read_stock(fields.required("stock"), source, scene);
  AccuracyRequest accuracy;
  if (const auto value = fields.find("accuracy")) accuracy = read_accuracy(*value);
  if (const auto force = fields.find("force")) scene.settings.force = read_force(*force);
  const auto tools = fields.required("tools").items();
  if (tools.empty()) fields.reject("tools", "must have at least one tool");
  for (const SceneValue& tool : tools) read_scene_tool(tool, scene.tools);
  if (const auto machine = fields.find("machine"))
    scene.machine = read_machine(*machine, scene.tools);
  if (const auto obstacles = fields.find("obstacles")) {
    for (const SceneValue& obstacle : obstacles->items()) read_obstacle(obstacle, source, scene);
  }
  const auto guides = fields.find("guides");
  fields.reject_unknown();
  apply_accuracy(accuracy, scene);
  apply_tolerance_to_tools(tools, scene);
  if (guides) read_scene_guides(*guides, source, scene);
  return scene;
}

SceneError error_at(TextPlace place, const SceneSource& source, std::string path,
                    std::string reason) {
  return {.file = source.name,
          .path = std::move(path),
          .line = place.line,
          .column = place.column,
          .reason = std::move(reason)};
}

SceneError json_error(const JsonFault& fault, std::string_view text, const SceneSource& source) {
  switch (fault.kind) {
    case JsonFaultKind::kRepeatedKey:
      return error_at(locate_json(text, fault.key), source, fault.key,
                      "appears twice in one object");
    case JsonFaultKind::kRange:
      return error_at({}, source, "", "contains a number that is out of range");
    case JsonFaultKind::kTooDeep:
      return error_at(
          {}, source, "",
          "has lists and objects nested more than " + std::to_string(kSceneDepthMax) + " deep");
    case JsonFaultKind::kSyntax:
    case JsonFaultKind::kTooMany:
    case JsonFaultKind::kStopped:
      break;
  }
  return error_at(place_of(text, fault.byte), source, "", "is not valid JSON");
}

// Parses bounded JSON and returns what `read` makes of it.
template <typename Read>
auto read_text(std::string_view text, const SceneSource& source, Read&& read)
    -> std::expected<decltype(read(std::declval<const Json&>())), SceneError> {
  if (text.size() > kSceneBytesMax)
    return std::unexpected(SceneError{.file = source.name,
                                      .path = {},
                                      .reason = "is " + std::to_string(text.size()) +
                                                " bytes; the limit is " +
                                                std::to_string(kSceneBytesMax)});
  const auto json = parse_bounded_json(text, {.depth_max = kSceneDepthMax});
  if (!json) return std::unexpected(json_error(json.error(), text, source));
  try {
    return read(*static_cast<const Json*>(json->get()));
  } catch (const SceneRejection& rejection) {
    return std::unexpected(
        error_at(locate_json(text, rejection.path), source, rejection.path, rejection.reason));
  } catch (const Json::exception& error) {
    // Thrown for numbers beyond the range of a double.
    return std::unexpected(error_at({}, source, "", "contains a number that is out of range"));
  }
}

}  // namespace

std::expected<Scene, SceneError> parse_scene(std::string_view text, const SceneSource& source) {
  return read_text(text, source, [&](const Json& json) { return read_scene(json, source); });
}

std::expected<SceneTool, SceneError> parse_scene_tool(std::string_view text, double tolerance_mm) {
  return read_text(text, {.name = "tool", .base_folder = {}}, [&](const Json& json) {
    const SceneValue value(&json, "");
    Scene scene;
    scene.settings.tolerance_mm = tolerance_mm;
    scene.tools.emplace(0, read_scene_tool(value));
    if (const auto resolved = resolve_chords(scene); !resolved)
      SceneFields(value).reject(resolved.error().error.field, resolved.error().error.reason);
    return scene.tools.at(0);
  });
}

}  // namespace kerf
