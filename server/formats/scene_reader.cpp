#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "server/formats/json_location.h"
#include "server/formats/scene.h"
#include "server/formats/stl.h"
#include "server/formats/text_file.h"

namespace kerf {
namespace {

using Json = nlohmann::json;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// A scene is written by hand; larger ones are a mistake or an attack.
constexpr std::size_t kSceneBytesMax = std::size_t{1} << 20;
constexpr std::size_t kSceneItemsMax = 1000;

// Leaves the reader from any depth; parse_scene catches it, nobody else sees it.
struct Refusal {
  std::string path, reason;
};

std::string number_text(double value) { return Json(value).dump(); }

// One JSON object while it is read: hands out its fields and, at the end, refuses those nobody
// asked for.
class Fields {
 public:
  Fields(const Json& json, std::string path) : json_(json), path_(std::move(path)) {
    if (!json.is_object()) throw Refusal{path_, "must be an object {…}"};
  }

  std::string path_of(const std::string& field) const {
    return path_.empty() ? field : path_ + "." + field;
  }
  [[noreturn]] void refuse(const std::string& field, const std::string& reason) const {
    throw Refusal{path_of(field), reason};
  }
  const Json* find(const std::string& field) {
    asked_.insert(field);
    const auto it = json_.find(field);
    return it == json_.end() ? nullptr : &*it;
  }
  const Json& need(const std::string& field) {
    const Json* value = find(field);
    if (value == nullptr) refuse(field, "is missing");
    return *value;
  }
  void not_yet(const std::string& field, const std::string& what) {
    if (find(field) != nullptr) refuse(field, what + " is not supported yet");
  }

  double as_number(const std::string& field, const Json& value, double above, double most) const {
    if (!value.is_number()) refuse(field, "must be a number");
    const double number = value.get<double>();
    if (!std::isfinite(number)) refuse(field, "must be a finite number");
    if (number <= above || number > most)
      refuse(field, "is " + number_text(number) + "; it must be above " + number_text(above) +
                        (most < kInfinity ? " and at most " + number_text(most) : ""));
    return number;
  }
  double positive(const std::string& field) { return as_number(field, need(field), 0, kInfinity); }
  double positive(const std::string& field, double otherwise) {
    const Json* value = find(field);
    return value == nullptr ? otherwise : as_number(field, *value, 0, kInfinity);
  }
  double any_number(const std::string& field) {
    return as_number(field, need(field), -kInfinity, kInfinity);
  }
  double not_negative(const std::string& field, double otherwise) {
    const Json* value = find(field);
    if (value == nullptr) return otherwise;
    const double number = as_number(field, *value, -kInfinity, kInfinity);
    if (number < 0) refuse(field, "is " + number_text(number) + "; it must not be negative");
    return number;
  }
  std::string text(const std::string& field) {
    const Json& value = need(field);
    if (!value.is_string()) refuse(field, "must be a text in quotes");
    return value.get<std::string>();
  }
  std::string text(const std::string& field, const std::string& otherwise) {
    return find(field) == nullptr ? otherwise : text(field);
  }
  template <std::size_t N>
  std::array<double, N> numbers(const std::string& field) {
    const Json& value = need(field);
    if (!value.is_array() || value.size() != N)
      refuse(field, "must be a list of " + std::to_string(N) + " numbers");
    std::array<double, N> result{};
    for (std::size_t i = 0; i < N; ++i)
      result[i] = as_number(field + "[" + std::to_string(i) + "]", value[i], -kInfinity, kInfinity);
    return result;
  }
  Vec3 vec3(const std::string& field) {
    const auto v = numbers<3>(field);
    return {v[0], v[1], v[2]};
  }
  const Json* list(const std::string& field) {
    const Json* value = find(field);
    if (value == nullptr) return nullptr;
    if (!value->is_array()) refuse(field, "must be a list […]");
    if (value->size() > kSceneItemsMax)
      refuse(field, "has more than " + std::to_string(kSceneItemsMax) + " items");
    return value;
  }

  // Call last.
  void refuse_the_rest() const {
    for (const auto& [field, value] : json_.items())
      if (!asked_.contains(field)) refuse(field, "is not a field of a scene");
  }

 private:
  const Json& json_;
  std::string path_;
  std::set<std::string> asked_;
};

void need_box(Fields& fields, Vec3 min, Vec3 max) {
  if (!(min.x < max.x && min.y < max.y && min.z < max.z))
    fields.refuse("max_mm", "must be greater than min_mm in every coordinate");
}

StockShape read_stock(const Json& json, const std::string& path) {
  Fields fields(json, path);
  const std::string shape = fields.text("shape");
  StockShape stock;
  if (shape == "box") {
    const BoxStock box{fields.vec3("min_mm"), fields.vec3("max_mm")};
    need_box(fields, box.min_mm, box.max_mm);
    stock = box;
  } else if (shape == "cylinder") {
    const auto center = fields.numbers<2>("center_mm");
    const CylinderStock cylinder{center[0], center[1], fields.positive("radius_mm"),
                                 fields.any_number("min_z_mm"), fields.any_number("max_z_mm")};
    if (!(cylinder.min_z_mm < cylinder.max_z_mm))
      fields.refuse("max_z_mm", "must be greater than min_z_mm");
    stock = cylinder;
  } else if (shape == "stl") {
    fields.refuse("shape", "a stock from an STL file is not supported yet; use box or cylinder");
  } else {
    fields.refuse("shape", "\"" + shape + "\" is not a stock shape; use box or cylinder");
  }
  fields.refuse_the_rest();
  return stock;
}

MotionModel read_motion(Fields& accuracy) {
  const std::string motion = accuracy.text("motion", "tight");
  if (motion == "tight") return MotionModel::kTight;
  if (motion == "paper") return MotionModel::kPaper;
  accuracy.refuse("motion", "\"" + motion + "\" is not a motion model; use tight or paper");
}

Rays read_rays(Fields& accuracy) {
  const std::string rays = accuracy.text("rays", "dexel");
  if (rays == "dexel") return Rays::kDexel;
  if (rays == "tri-dexel") return Rays::kTriDexel;
  accuracy.refuse("rays", "\"" + rays + "\" is not a ray model; use dexel or tri-dexel");
}

void read_accuracy(const Json& json, SculptureSettings& settings) {
  Fields fields(json, "accuracy");
  fields.not_yet("target_mm", "choosing the accuracy from a target");
  settings.rays = read_rays(fields);
  settings.pitch_mm = fields.positive("pitch_mm", settings.pitch_mm);
  settings.tolerance_mm = fields.positive("tolerance_mm", settings.tolerance_mm);
  settings.motion = read_motion(fields);
  fields.refuse_the_rest();
}

ForceSettings read_force(const Json& json) {
  Fields fields(json, "force");
  ForceSettings force;
  const std::string law = fields.text("law", "specific_energy");
  if (law == "drr") {
    force.law = ForceLaw::kDexelRemovalRate;
  } else if (law != "specific_energy") {
    fields.refuse("law", "\"" + law + "\" is not a force law; use specific_energy or drr");
  }
  force.specific_force_n_per_mm2 =
      fields.not_negative("specific_force_n_per_mm2", force.specific_force_n_per_mm2);
  force.drr_n_s_per_mm3 = fields.not_negative("drr_n_s_per_mm3", force.drr_n_s_per_mm3);
  force.pivot_mm = fields.not_negative("pivot_mm", force.pivot_mm);
  fields.refuse_the_rest();
  return force;
}

TaperTip read_taper_tip(Fields& fields) {
  const std::string tip = fields.text("tip", "flat");
  if (tip == "flat") return TaperTip::kFlat;
  if (tip == "ball") return TaperTip::kBall;
  fields.refuse("tip", "\"" + tip + "\" is not a tip; use flat or ball");
}

ToolShape read_tool_shape(Fields& fields) {
  const std::string shape = fields.text("shape");
  if (shape == "ball")
    return BallShape{fields.positive("diameter_mm"), fields.positive("length_mm")};
  if (shape == "flat")
    return FlatShape{fields.positive("diameter_mm"), fields.positive("length_mm")};
  if (shape == "taper")
    return TaperShape{fields.positive("diameter_mm"), fields.positive("half_angle_deg"),
                      fields.positive("length_mm"), read_taper_tip(fields)};
  if (shape == "cone_end")
    return ConeEndShape{fields.positive("diameter_mm"), fields.positive("tip_angle_deg"),
                        fields.positive("length_mm")};
  if (shape == "bull_nose" || shape == "apt" || shape == "profile")
    fields.refuse("shape", "the tool shape " + shape + " is not supported yet");
  fields.refuse("shape",
                "\"" + shape + "\" is not a tool shape; use ball, flat, taper or cone_end");
}

ToolId read_tool_id(Fields& fields) {
  const double id = fields.positive("id");
  if (id != std::floor(id) || id > std::numeric_limits<ToolId>::max())
    fields.refuse("id", "must be a whole number from 1 to 4294967295");
  return static_cast<ToolId>(id);
}

void read_tool(const Json& json, const std::string& path, Scene& scene) {
  Fields fields(json, path);
  const ToolId id = read_tool_id(fields);
  if (scene.tools.contains(id))
    fields.refuse("id", "is " + std::to_string(id) + ", which another tool has already");
  fields.not_yet("shank", "a shank");
  fields.not_yet("holder", "a holder");
  const ToolShape shape = read_tool_shape(fields);
  fields.refuse_the_rest();
  auto tool = make_tool(shape);
  if (!tool) fields.refuse(tool.error().field, tool.error().reason);
  scene.tools.emplace(id, SceneTool{shape, *std::move(tool)});
}

Machine read_machine(const Json& json) {
  Fields fields(json, "machine");
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
    fields.refuse(
        "kinematics",
        "\"" + kinematics + "\" is not known; use xyz, xyzac-trt, xyzbc-trt or tool-vector");
  machine.rapid_mm_per_min = fields.positive("rapid_mm_per_min", machine.rapid_mm_per_min);
  fields.refuse_the_rest();
  return machine;
}

MeshObstacle read_mesh_obstacle(Fields& fields, const SceneSource& source) {
  const std::string name = fields.text("file");
  if (!source.base_folder)
    fields.refuse("file", "this scene may not name files: it did not come from a folder");
  const auto bytes = read_file(*source.base_folder / name);
  if (!bytes) fields.refuse("file", "\"" + name + "\" cannot be read");
  auto triangles = read_stl(std::as_bytes(std::span(*bytes)));
  if (!triangles) fields.refuse("file", "\"" + name + "\": " + triangles.error().reason);
  return MeshObstacle{*std::move(triangles)};
}

void read_obstacle(const Json& json, const std::string& path, const SceneSource& source,
                   Scene& scene) {
  Fields fields(json, path);
  const std::string shape = fields.text("shape");
  Obstacle obstacle;
  std::string file;
  if (shape == "box") {
    const BoxObstacle box{fields.vec3("min_mm"), fields.vec3("max_mm")};
    need_box(fields, box.min_mm, box.max_mm);
    obstacle.shape = box;
  } else if (shape == "cylinder") {
    const CylinderObstacle cylinder{fields.vec3("from_mm"), fields.vec3("to_mm"),
                                    fields.positive("radius_mm")};
    if (cylinder.from_mm == cylinder.to_mm) fields.refuse("to_mm", "must differ from from_mm");
    obstacle.shape = cylinder;
  } else if (shape == "sphere") {
    obstacle.shape = SphereObstacle{fields.vec3("center_mm"), fields.positive("radius_mm")};
  } else if (shape == "stl") {
    file = fields.text("file");
    obstacle.shape = read_mesh_obstacle(fields, source);
  } else {
    fields.refuse("shape",
                  "\"" + shape + "\" is not an obstacle; use box, cylinder, sphere or stl");
  }
  obstacle.stiffness_n_per_mm = fields.positive("stiffness_n_per_mm", obstacle.stiffness_n_per_mm);
  fields.refuse_the_rest();
  scene.settings.obstacles.push_back(std::move(obstacle));
  scene.obstacle_files.push_back(std::move(file));
}

Scene read_scene(const Json& json, const SceneSource& source) {
  Fields fields(json, "");
  Scene scene;
  scene.name = fields.text("name", "untitled");
  scene.settings.stock = read_stock(fields.need("stock"), "stock");
  if (const Json* accuracy = fields.find("accuracy")) read_accuracy(*accuracy, scene.settings);
  if (const Json* force = fields.find("force")) scene.settings.force = read_force(*force);
  if (const Json* machine = fields.find("machine")) scene.machine = read_machine(*machine);
  fields.need("tools");
  const Json& tools = *fields.list("tools");
  if (tools.empty()) fields.refuse("tools", "must have at least one tool");
  for (std::size_t i = 0; i < tools.size(); ++i)
    read_tool(tools[i], "tools[" + std::to_string(i) + "]", scene);
  if (const Json* obstacles = fields.list("obstacles"))
    for (std::size_t i = 0; i < obstacles->size(); ++i)
      read_obstacle((*obstacles)[i], "obstacles[" + std::to_string(i) + "]", source, scene);
  fields.refuse_the_rest();
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

// nlohmann keeps the last of two equal keys without a word; a scene that says a thing twice is
// refused.
class DuplicateKeys {
 public:
  bool operator()(int /*depth*/, Json::parse_event_t event, Json& parsed) {
    if (event == Json::parse_event_t::object_start) open_.emplace_back();
    if (event == Json::parse_event_t::object_end) open_.pop_back();
    if (event == Json::parse_event_t::key && !open_.back().insert(parsed.get<std::string>()).second)
      throw Refusal{parsed.get<std::string>(), "is given twice in one object"};
    return true;
  }

 private:
  std::vector<std::set<std::string>> open_;
};

}  // namespace

std::expected<Scene, SceneError> parse_scene(std::string_view text, const SceneSource& source) {
  if (text.size() > kSceneBytesMax)
    return std::unexpected(
        SceneError{.file = source.name,
                   .path = {},
                   .reason = "is larger than " + std::to_string(kSceneBytesMax) + " bytes"});
  try {
    // The callback is copied by the parser, so the keys live outside of it.
    DuplicateKeys keys;
    const Json json =
        Json::parse(text, [&keys](int depth, Json::parse_event_t event, Json& parsed) {
          return keys(depth, event, parsed);
        });
    return read_scene(json, source);
  } catch (const Refusal& refusal) {
    return std::unexpected(
        error_at(locate_json(text, refusal.path), source, refusal.path, refusal.reason));
  } catch (const Json::parse_error& error) {
    const TextPlace place = place_of(text, error.byte > 0 ? error.byte - 1 : 0);
    return std::unexpected(error_at(place, source, "", "is not JSON here"));
  } catch (const Json::exception& error) {
    // Numbers beyond the range of a double end here.
    return std::unexpected(error_at({}, source, "", "has a value that cannot be read"));
  }
}

}  // namespace kerf
