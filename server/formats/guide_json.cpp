// SPDX-License-Identifier: Apache-2.0
#include "server/formats/guide_json.h"

#include <nlohmann/json.hpp>
#include <type_traits>

namespace kerf {
namespace {

using OrderedJson = nlohmann::ordered_json;

OrderedJson vector_json(Vec3 v) { return OrderedJson::array({v.x, v.y, v.z}); }

OrderedJson paths_json(const PathGuide& guide) {
  OrderedJson paths = OrderedJson::array();
  for (const GuidePath& path : guide.paths) {
    OrderedJson poses = OrderedJson::array();
    for (const GuidePose& pose : path) {
      OrderedJson numbers = OrderedJson::array();
      for (const Vec3& v : {pose.tip_mm, pose.axis}) {
        numbers.insert(numbers.end(), {v.x, v.y, v.z});
      }
      if (guide.stroke) {
        for (const Vec3& v : {pose.felt.force_n, pose.felt.torque_nmm})
          numbers.insert(numbers.end(), {v.x, v.y, v.z});
      }
      poses.push_back(std::move(numbers));
    }
    paths.push_back(std::move(poses));
  }
  return paths;
}

void add_shape(OrderedJson& json, const PathGuide& guide, GuideFiles files) {
  if (guide.file.empty() || files == GuideFiles::kExpanded) {
    json["paths"] = paths_json(guide);
  } else {
    json["file"] = guide.file;
  }
  json["within_mm"] = guide.within_mm;
  json["axis_within_deg"] = guide.axis_within_deg;
  json["turn_stiffness_nmm_per_rad"] = guide.turn_stiffness_nmm_per_rad;
  json["max_torque_nmm"] = guide.max_torque_nmm;
  if (guide.stroke) json["felt_share"] = guide.felt_share;
}
void add_shape(OrderedJson& json, const PlaneGuide& guide, GuideFiles /*files*/) {
  json["point_mm"] = vector_json(guide.point_mm);
  json["normal"] = vector_json(guide.normal);
}
void add_shape(OrderedJson& json, const DepthGuide& guide, GuideFiles /*files*/) {
  json["lowest_z_mm"] = guide.lowest_z_mm;
}
void add_shape(OrderedJson& json, const RegionGuide& guide, GuideFiles /*files*/) {
  json["min_mm"] = vector_json(guide.min_mm);
  json["max_mm"] = vector_json(guide.max_mm);
}
void add_shape(OrderedJson& json, const SnapGuide& guide, GuideFiles /*files*/) {
  json["range_mm"] = guide.range_mm;
  if (!guide.surface) return;
  json["surface"] = {{"shape", guide.surface->cylinder ? "cylinder" : "box"},
                     {"min_mm", vector_json(guide.surface->min_mm)},
                     {"max_mm", vector_json(guide.surface->max_mm)}};
}

}  // namespace

std::string guides_json(const std::vector<Guide>& guides, GuideFiles files) {
  OrderedJson list = OrderedJson::array();
  for (const Guide& guide : guides) {
    OrderedJson json{{"kind", kind_of(guide)}};
    std::visit([&](const auto& shape) { add_shape(json, shape, files); }, guide.shape);
    json["stiffness_n_per_mm"] = guide.stiffness_n_per_mm;
    json["max_force_n"] = guide.max_force_n;
    list.push_back(std::move(json));
  }
  return list.dump(-1, ' ', false, OrderedJson::error_handler_t::replace);
}

}  // namespace kerf
