// SPDX-License-Identifier: Apache-2.0
#include "server/formats/guide_reader.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "kernel/sculpture_settings.h"

namespace kerf {
namespace {

constexpr double kDegreesMax = 180;
constexpr std::size_t kPoseNumbers = 6, kStrokeNumbers = 12;

/// Sanity limits of a guide, above any device.
constexpr double kStiffnessMax = 100;
constexpr double kTurnStiffnessMax = 1e5;
constexpr double kForceMaxN = 50;
constexpr double kTorqueMaxNmm = 2000;

double limited(SceneFields& fields, const std::string& field, double standard, double most) {
  const auto value = fields.find(field);
  return value ? value->number(0, most) : standard;
}

bool within(Vec3 v, double most) {
  return std::abs(v.x) <= most && std::abs(v.y) <= most && std::abs(v.z) <= most;
}

/// Returns the reason why a pose from any source cannot be used, or empty if it can.
const char* pose_fault(const GuidePose& pose) {
  if (!within(pose.tip_mm, kCoordinateMaxMm)) return "has a coordinate beyond 1000000 mm";
  if (within(pose.felt.force_n, kGuideFeltMax) && within(pose.felt.torque_nmm, kGuideFeltMax))
    return "";
  return "has a force or torque beyond 1000000 N or Nmm";
}

double coordinate(const SceneValue& value, double number) {
  if (!(std::abs(number) <= kCoordinateMaxMm)) value.reject("is beyond 1000000 mm");
  return number;
}

Vec3 point(SceneFields& fields, const std::string& field) {
  const SceneValue value = fields.required(field);
  const auto v = value.numbers<3>();
  for (const double number : v) coordinate(value, number);
  return {v[0], v[1], v[2]};
}

Vec3 unit(const SceneValue& value, Vec3 v) {
  if (!(length(v) > kGuideAxisMin)) value.reject("must not be zero");
  if (!(length(v) <= kGuideAxisMax)) value.reject("has a direction longer than 1000000");
  return normalized(v);
}

GuidePose read_pose(const SceneValue& value, bool stroke) {
  if (stroke) {
    const auto v = value.numbers<kStrokeNumbers>();
    return {.tip_mm = {v[0], v[1], v[2]},
            .axis = unit(value, {v[3], v[4], v[5]}),
            .felt = {{v[6], v[7], v[8]}, {v[9], v[10], v[11]}}};
  }
  const auto v = value.numbers<kPoseNumbers>();
  return {.tip_mm = {v[0], v[1], v[2]}, .axis = unit(value, {v[3], v[4], v[5]})};
}

std::vector<GuidePath> read_paths(const SceneValue& list, bool stroke) {
  std::vector<GuidePath> paths;
  for (const SceneValue& item : list.items(kGuidePosesMax)) {
    GuidePath path;
    for (const SceneValue& pose : item.items(kGuidePosesMax)) {
      path.push_back(read_pose(pose, stroke));
      if (const std::string fault = pose_fault(path.back()); !fault.empty()) pose.reject(fault);
    }
    if (path.empty()) item.reject("must have at least one pose");
    paths.push_back(std::move(path));
  }
  if (paths.empty()) list.reject("must have at least one path");
  return paths;
}

PathGuide read_path(SceneFields& fields, bool stroke, const GuideFile& read_file) {
  PathGuide guide;
  guide.stroke = stroke;
  guide.within_mm = limited(fields, "within_mm", guide.within_mm, kCoordinateMaxMm);
  guide.axis_within_deg = limited(fields, "axis_within_deg", guide.axis_within_deg, kDegreesMax);
  guide.turn_stiffness_nmm_per_rad = limited(fields, "turn_stiffness_nmm_per_rad",
                                             guide.turn_stiffness_nmm_per_rad, kTurnStiffnessMax);
  guide.max_torque_nmm = limited(fields, "max_torque_nmm", guide.max_torque_nmm, kTorqueMaxNmm);
  if (stroke) {
    guide.felt_share = fields.not_negative("felt_share", guide.felt_share);
    if (guide.felt_share > kGuideFeltShareMax) fields.reject("felt_share", "must be at most 10");
  }
  const auto paths = fields.find("paths");
  const auto file = fields.find("file");
  if (paths && file) fields.reject("file", "must not be given together with \"paths\"");
  if (paths) {
    guide.paths = read_paths(*paths, stroke);
    return guide;
  }
  guide.file = fields.text("file");
  if (!read_file) fields.reject("file", "may not name a file");
  guide.paths = read_file(fields, guide);
  for (const GuidePath& path : guide.paths) {
    for (const GuidePose& pose : path) {
      if (const std::string fault = pose_fault(pose); !fault.empty()) fields.reject("file", fault);
    }
  }
  return guide;
}

RegionGuide read_region(SceneFields& fields) {
  const RegionGuide region{point(fields, "min_mm"), point(fields, "max_mm")};
  const Vec3 size = region.max_mm - region.min_mm;
  if (!(size.x > 0 && size.y > 0 && size.z > 0))
    fields.reject("max_mm", "must be greater than min_mm in every coordinate");
  return region;
}

SnapGuide read_snap(SceneFields& fields) {
  SnapGuide guide{.range_mm = limited(fields, "range_mm", SnapGuide{}.range_mm, kCoordinateMaxMm),
                  .surface = {}};
  const auto surface = fields.find("surface");
  if (!surface) return guide;
  SceneFields shape(*surface);
  const std::string name = shape.text("shape");
  if (name != "box" && name != "cylinder")
    shape.reject("shape", "\"" + name + "\" is not a surface to snap to; use box or cylinder");
  const RegionGuide box = read_region(shape);
  shape.reject_unknown();
  guide.surface = SnapSurface{name == "cylinder", box.min_mm, box.max_mm};
  return guide;
}

Guide read_guide(const SceneValue& value, const GuideFile& read_file) {
  SceneFields fields(value);
  Guide guide;
  const std::string kind = fields.text("kind");
  if (kind == "path" || kind == "stroke") {
    guide.shape = read_path(fields, kind == "stroke", read_file);
  } else if (kind == "plane") {
    const SceneValue normal = fields.required("normal");
    const auto n = normal.numbers<3>();
    guide.shape = PlaneGuide{point(fields, "point_mm"), unit(normal, {n[0], n[1], n[2]})};
  } else if (kind == "depth") {
    const SceneValue lowest = fields.required("lowest_z_mm");
    guide.shape = DepthGuide{coordinate(lowest, lowest.number())};
  } else if (kind == "region") {
    guide.shape = read_region(fields);
  } else if (kind == "snap") {
    guide.shape = read_snap(fields);
  } else {
    fields.reject("kind", "\"" + kind +
                              "\" is not a kind of guide; use path, stroke, plane, depth, region "
                              "or snap");
  }
  guide.stiffness_n_per_mm =
      limited(fields, "stiffness_n_per_mm", guide.stiffness_n_per_mm, kStiffnessMax);
  guide.max_force_n = limited(fields, "max_force_n", guide.max_force_n, kForceMaxN);
  fields.reject_unknown();
  return guide;
}

}  // namespace

std::vector<Guide> read_guides(const SceneValue& list, const GuideFile& read_file) {
  std::vector<Guide> guides;
  std::size_t poses = 0;
  for (const SceneValue& item : list.items(kGuidesMax)) {
    guides.push_back(read_guide(item, read_file));
    const auto* path = std::get_if<PathGuide>(&guides.back().shape);
    if (path == nullptr) continue;
    for (const GuidePath& one : path->paths) poses += one.size();
    if (poses > kGuidePosesMax) {
      item.reject("and the guides before it have " + std::to_string(poses) +
                  " poses; the limit is " + std::to_string(kGuidePosesMax));
    }
  }
  return guides;
}

std::expected<std::vector<Guide>, std::string> parse_guides(std::string_view object) {
  const auto json = nlohmann::json::parse(object, nullptr, false);
  if (!json.is_object()) return std::unexpected("is not a JSON object");
  try {
    const auto list = json.find("guides");
    if (list == json.end()) return std::vector<Guide>{};
    const SceneValue value(&*list, "guides");
    auto guides = read_guides(value, nullptr);
    for (const Guide& guide : guides) {
      const auto* snap = std::get_if<SnapGuide>(&guide.shape);
      if (snap != nullptr && !snap->surface) value.reject("has a snap guide without a surface");
    }
    return guides;
  } catch (const SceneRejection& rejection) {
    return std::unexpected(rejection.path + " " + rejection.reason);
  }
}

const char* kind_of(const Guide& guide) {
  if (const auto* path = std::get_if<PathGuide>(&guide.shape))
    return path->stroke ? "stroke" : "path";
  if (std::holds_alternative<PlaneGuide>(guide.shape)) return "plane";
  if (std::holds_alternative<DepthGuide>(guide.shape)) return "depth";
  return std::holds_alternative<RegionGuide>(guide.shape) ? "region" : "snap";
}

}  // namespace kerf
