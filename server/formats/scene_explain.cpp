// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "kernel/force/ripple.h"
#include "server/formats/scene.h"

namespace kerf {
namespace {

using Json = nlohmann::ordered_json;

struct FieldHelp {
  std::string_view path;      ///< without list indices, e.g. "tools[].id"
  std::string_view standard;  ///< default; "-" if the field is required
  std::string_view unit;
  std::string_view meaning;
};

constexpr std::array kHelp{
    FieldHelp{"name", "untitled", "", "name in file heads and viewers"},
    FieldHelp{"stock.shape", "-", "", "box, cylinder or mesh (alias: stl)"},
    FieldHelp{"stock.file", "-", "",
              "closed mesh (.stl .ply .obj .3mf .glb), relative to the scene"},
    FieldHelp{"stock.repair", "false", "", "close holes of the mesh and orient its triangles"},
    FieldHelp{"stock.placement.unit", "mm", "", "unit of the file's numbers: mm, cm, m or inch"},
    FieldHelp{"stock.placement.scale", "[1, 1, 1]", "", "factors along the file's x, y and z"},
    FieldHelp{"stock.placement.rotate_deg", "[0, 0, 0]", "deg",
              "angles about the scene's x, then y, then z"},
    FieldHelp{"stock.placement.translate_mm", "[0, 0, 0]", "mm", "where the origin of the file is"},
    FieldHelp{"stock.min_mm", "-", "mm", "lowest corner of the block"},
    FieldHelp{"stock.max_mm", "-", "mm", "highest corner of the block"},
    FieldHelp{"stock.center_mm", "-", "mm", "x and y of the upright cylinder's axis"},
    FieldHelp{"stock.radius_mm", "-", "mm", "radius of the cylinder"},
    FieldHelp{"stock.min_z_mm", "-", "mm", "lower end of the cylinder"},
    FieldHelp{"stock.max_z_mm", "-", "mm", "upper end of the cylinder"},
    FieldHelp{"accuracy.target_mm", "none", "mm",
              "target surface error; of the next four, unset fields are chosen to meet it"},
    FieldHelp{"accuracy.rays", "dexel", "",
              "dexel: one field of rays along Z; tri-dexel: three, along X, Y and Z"},
    FieldHelp{"accuracy.pitch_mm", "0.25", "mm", "distance between neighboring rays"},
    FieldHelp{"accuracy.tolerance_mm", "0.01", "mm",
              "greatest error of a dexel end and of an arc's chord"},
    FieldHelp{"accuracy.motion", "tight", "", "tight (second order) or paper (Eq. 12)"},
    FieldHelp{"tools[].id", "-", "", "T number, LOADTL number"},
    FieldHelp{"tools[].shape", "-", "", "ball, flat, bull_nose, taper, cone_end, apt or profile"},
    FieldHelp{"tools[].diameter_mm", "-", "mm", "diameter (taper: at the tip)"},
    FieldHelp{"tools[].length_mm", "-", "mm", "cutting length from the tip up"},
    FieldHelp{"tools[].half_angle_deg", "-", "deg", "angle between axis and side of a taper"},
    FieldHelp{"tools[].tip", "flat", "", "tip of a taper: flat or ball"},
    FieldHelp{"tools[].tip_angle_deg", "-", "deg", "included angle of the cone at the tip"},
    FieldHelp{"tools[].corner_radius_mm", "-", "mm", "edge radius of a bull_nose; 0: flat"},
    FieldHelp{"tools[].d_mm", "-", "mm",
              "apt: diameter at the intersection of bottom and side line"},
    FieldHelp{"tools[].r_mm", "-", "mm", "apt: corner radius; 0: sharp corner"},
    FieldHelp{"tools[].e_mm", "-", "mm",
              "apt: distance of the corner's center from the axis; < 0: barrel"},
    FieldHelp{"tools[].f_mm", "-", "mm", "apt: height of the corner's center above the tip"},
    FieldHelp{"tools[].alpha_deg", "-", "deg", "apt: angle of the bottom line from the horizontal"},
    FieldHelp{"tools[].beta_deg", "-", "deg",
              "apt: angle of the side line from the axis; < 0: undercut"},
    FieldHelp{"tools[].h_mm", "-", "mm", "apt: height of the cutter"},
    FieldHelp{"tools[].profile_mm", "-", "mm",
              "[r, h] lines; {to, radius or center, bulge out|in} arcs; from the tip up"},
    FieldHelp{"tools[].chord_tolerance_mm", "tolerance_mm / 10", "mm",
              "greatest deviation of a profile's fillets"},
    FieldHelp{"tools[].shank.diameter_mm", "-", "mm",
              "shank diameter; the shank stands on the cutting length"},
    FieldHelp{"tools[].shank.length_mm", "-", "mm", "shank length above the cutting length"},
    FieldHelp{"tools[].holder", "[]", "", "holder sections above the shank, from below"},
    FieldHelp{"tools[].holder[].diameter_mm", "-", "mm", "diameter of the section's lower end"},
    FieldHelp{"tools[].holder[].top_diameter_mm", "diameter_mm", "mm",
              "diameter of the section's upper end"},
    FieldHelp{"tools[].holder[].length_mm", "-", "mm", "height of a section"},
    FieldHelp{"tools[].holder.profile_mm", "-", "mm",
              "outline as of a tool profile, from height 0"},
    FieldHelp{"tools[].holder.chord_tolerance_mm", "tolerance_mm / 10", "mm",
              "as of a tool profile"},
    FieldHelp{"force.law", "specific_energy", "",
              "specific_energy: F = u A; drr: F = K dV/dt (the paper's); mechanistic: of a milling "
              "cutter"},
    FieldHelp{"force.specific_force_n_per_mm2", "0.5", "N/mm2", "u of specific_energy"},
    FieldHelp{"force.drr_n_s_per_mm3", "0.0005", "N s/mm3", "K of drr"},
    FieldHelp{"force.pivot_mm", "60", "mm", "distance of the torque's pivot from the tip"},
    FieldHelp{"force.contact_stiffness_n_per_mm", "1", "N/mm",
              "contact stiffness of stock against shank and holder"},
    FieldHelp{"force.spindle_rpm", "12000", "1/min", "speed of the spindle, clockwise (M3)"},
    FieldHelp{"force.teeth", "2", "", "number of teeth"},
    FieldHelp{"force.helix_deg", "30", "deg", "right-hand helix of the teeth"},
    FieldHelp{"force.feed_per_tooth_mm", "0", "mm", "fixed chip load; 0: that of the tool's speed"},
    FieldHelp{"force.runout_mm", "0", "mm", "offset of the tool from the spindle's axis"},
    FieldHelp{"force.ripple_hz", "250", "Hz", "greatest frequency of the ripple of the teeth"},
    FieldHelp{"force.scale", "1", "", "share of the wrench that is computed"},
    FieldHelp{"force.tangential_n_per_mm2", "material", "N/mm2", "force per chip area"},
    FieldHelp{"force.radial_n_per_mm2", "material", "N/mm2", "likewise, into the tool"},
    FieldHelp{"force.axial_n_per_mm2", "material", "N/mm2", "likewise, towards the tip"},
    FieldHelp{"force.tangential_edge_n_per_mm", "material", "N/mm", "force per engaged edge"},
    FieldHelp{"force.radial_edge_n_per_mm", "material", "N/mm", "likewise, into the tool"},
    FieldHelp{"force.axial_edge_n_per_mm", "material", "N/mm", "likewise, towards the tip"},
    FieldHelp{"force.chip_exponent", "material", "", "m of Kienzle's law, in all directions"},
    FieldHelp{"force.tangential_chip_exponent", "chip_exponent", "", "m of the tangential force"},
    FieldHelp{"force.radial_chip_exponent", "chip_exponent", "", "m of the radial force"},
    FieldHelp{"force.axial_chip_exponent", "chip_exponent", "", "m of the axial force"},
    FieldHelp{"machine.kinematics", "xyz", "", "xyz, xyzac-trt, xyzbc-trt or tool-vector"},
    FieldHelp{
        "machine.dialect", "auto", "",
        "language of programs: auto, linuxcnc, grbl, mach3, fanuc, haas, heidenhain, siemens"},
    FieldHelp{"machine.rotary_direction", "table", "",
              "table: a positive angle turns the table (LinuxCNC); tool: the tool relative to the "
              "workpiece (ISO 841)"},
    FieldHelp{"machine.spindle_tool", "-", "", "tool in the spindle until the first tool change"},
    FieldHelp{"machine.rapid_mm_per_min", "10000", "mm/min", "traverse rate of G0 and RAPID"},
    FieldHelp{"machine.feed_max_mm_per_min", "rapid_mm_per_min", "mm/min",
              "X,Y,Z: the fastest speed of each linear axis, for the time on the machine"},
    FieldHelp{"machine.acceleration_mm_per_s2", "[3000,3000,3000]", "mm/s2",
              "X,Y,Z: acceleration of each linear axis, likewise"},
    FieldHelp{"machine.turn_max_rad_per_s", "1", "rad/s",
              "the fastest turn of the tool's axis in the workpiece, likewise"},
    FieldHelp{"machine.turn_acceleration_rad_per_s2", "10", "rad/s2",
              "acceleration of that turn, likewise"},
    FieldHelp{"obstacles", "[]", "", "bodies that push back and are never cut"},
    FieldHelp{"obstacles[].shape", "-", "", "box, cylinder, sphere or mesh"},
    FieldHelp{"obstacles[].min_mm", "-", "mm", "lowest corner of the box"},
    FieldHelp{"obstacles[].max_mm", "-", "mm", "highest corner of the box"},
    FieldHelp{"obstacles[].from_mm", "-", "mm", "one end of the cylinder's axis"},
    FieldHelp{"obstacles[].to_mm", "-", "mm", "other end of the cylinder's axis"},
    FieldHelp{"obstacles[].radius_mm", "-", "mm", "radius of the cylinder or sphere"},
    FieldHelp{"obstacles[].center_mm", "-", "mm", "center of the sphere"},
    FieldHelp{"obstacles[].file", "-", "", "STL, PLY, OBJ, 3MF or GLB file, as of the stock"},
    FieldHelp{"obstacles[].repair", "false", "", "as of the stock"},
    FieldHelp{"obstacles[].placement.unit", "mm", "", "as of the stock"},
    FieldHelp{"obstacles[].placement.scale", "[1, 1, 1]", "", "as of the stock"},
    FieldHelp{"obstacles[].placement.rotate_deg", "[0, 0, 0]", "deg", "as of the stock"},
    FieldHelp{"obstacles[].placement.translate_mm", "[0, 0, 0]", "mm", "as of the stock"},
    FieldHelp{"obstacles[].stiffness_n_per_mm", "1", "N/mm", "force per depth of penetration"},
    FieldHelp{"guides", "[]", "", "virtual fixtures that haptic devices feel; they cut nothing"},
    FieldHelp{"guides[].kind", "-", "", "path, stroke, plane, depth, region or snap"},
    FieldHelp{"guides[].file", "-", "", "path: a program; stroke: a forces file (CSV)"},
    FieldHelp{"guides[].paths", "-", "",
              "in place of file: lists of poses [x, y, z, i, j, k]; stroke: and the wrench"},
    FieldHelp{"guides[].within_mm", "3", "mm", "distance of the tip from the path without force"},
    FieldHelp{"guides[].axis_within_deg", "180", "deg", "angle from the path's axis likewise"},
    FieldHelp{"guides[].turn_stiffness_nmm_per_rad", "1000", "Nmm/rad", "torque beyond that angle"},
    FieldHelp{"guides[].max_torque_nmm", "60", "Nmm", "greatest torque of the guide"},
    FieldHelp{"guides[].felt_share", "1", "", "share of a stroke's recorded wrench that is felt"},
    FieldHelp{"guides[].point_mm", "-", "mm", "a point of the plane"},
    FieldHelp{"guides[].normal", "-", "", "side of the plane on which the tip may be"},
    FieldHelp{"guides[].lowest_z_mm", "-", "mm", "depth limit of the tip"},
    FieldHelp{"guides[].min_mm", "-", "mm", "lowest corner of the region that the tip stays off"},
    FieldHelp{"guides[].max_mm", "-", "mm", "its highest corner"},
    FieldHelp{"guides[].range_mm", "5", "mm", "snap: distance from which the surface attracts"},
    FieldHelp{"guides[].surface.shape", "that of the stock", "", "snap: box or cylinder"},
    FieldHelp{"guides[].surface.min_mm", "-", "mm", "lowest corner of its bounding box"},
    FieldHelp{"guides[].surface.max_mm", "-", "mm", "highest corner of its bounding box"},
    FieldHelp{"guides[].stiffness_n_per_mm", "1", "N/mm", "force per distance; devices limit it"},
    FieldHelp{"guides[].max_force_n", "3", "N", "greatest force of the guide"},
};

struct Row {
  std::string path, value;
};

// Appends one row per value. A list of numbers is one value. Objects and lists of objects are
// descended into.
void flatten(const Json& json, const std::string& path, std::vector<Row>& rows) {
  if (json.is_object()) {
    const std::string prefix = path.empty() ? "" : path + ".";
    for (const auto& [key, value] : json.items()) flatten(value, prefix + key, rows);
  } else if (json.is_array() && !json.empty() && json.front().is_object()) {
    for (std::size_t i = 0; i < json.size(); ++i)
      flatten(json[i], path + "[" + std::to_string(i) + "]", rows);
  } else {
    rows.push_back({path, json.is_string() ? json.get<std::string>() : json.dump()});
  }
}

std::string without_indices(const std::string& path) {
  std::string result;
  bool index = false;
  for (const char c : path) {
    if (c == ']') index = false;
    if (!index) result += c;
    if (c == '[') index = true;
  }
  return result;
}

/// States the engagement at which the force of each tool is steady.
std::string force_note(const Scene& scene) {
  const SculptureSettings& s = scene.settings;
  std::ostringstream out;
  out << "\nforce: where a wall along the rays is cut, it ripples by at most 5 % rms from this "
         "radial "
         "engagement on";
  const char* separator = ": ";
  bool never = false;
  const int fields = s.rays == Rays::kDexel ? 1 : 3;
  for (const auto& [id, tool] : scene.tools) {
    const double diameter_mm = 2 * tool.tool.radius_mm;
    const double steady_mm = steady_radial_mm(fields, s.pitch_mm, diameter_mm);
    out << std::exchange(separator, ", ") << "tool " << id << " ";
    if (steady_mm <= diameter_mm) {
      // Two significant digits, in plain decimals also from 100 mm on.
      const double step = std::pow(10.0, std::floor(std::log10(steady_mm)) - 1);
      out << std::setprecision(6) << std::round(steady_mm / step) * step << " mm";
    } else {
      out << "none";
      never = true;
    }
  }
  if (fields == 1) out << "; with tri-dexel from " << 5 * s.pitch_mm << " mm";
  if (never) out << " (none: the pitch is too coarse for the tool)";
  out << '\n';
  return out.str();
}

}  // namespace

std::string explain_scene(const Scene& scene) {
  std::vector<Row> rows;
  flatten(Json::parse(scene_json(scene)), "", rows);
  if (!scene.accuracy) {
    const auto at = std::ranges::find(rows, "accuracy.rays", &Row::path);
    rows.insert(at, {"accuracy.target_mm", "none"});
  }
  if (scene.guides.empty()) rows.push_back({"guides", "[]"});
  std::size_t path_width = 5;
  std::size_t value_width = 5;
  for (const Row& row : rows) {
    path_width = std::max(path_width, row.path.size());
    value_width = std::max(value_width, row.value.size());
  }
  std::ostringstream out;
  const auto line = [&](std::string_view path, std::string_view value, std::string_view standard,
                        std::string_view unit, std::string_view meaning) {
    const auto pad = [&out](std::string_view text, std::size_t width) {
      out << text << std::string(width > text.size() ? width - text.size() : 0, ' ') << "  ";
    };
    pad(path, path_width);
    pad(value, value_width);
    pad(standard, 15);
    pad(unit, 8);
    out << meaning << '\n';
  };
  line("field", "value", "default", "unit", "meaning");
  for (const Row& row : rows) {
    const std::string path = without_indices(row.path);
    const auto help = std::find_if(kHelp.begin(), kHelp.end(),
                                   [&path](const FieldHelp& h) { return h.path == path; });
    if (help == kHelp.end()) {
      line(row.path, row.value, "", "", "");
    } else {
      line(row.path, row.value, help->standard == "-" ? "(required)" : help->standard, help->unit,
           help->meaning);
    }
  }
  out << force_note(scene);
  if (scene.accuracy)
    out << "\naccuracy for a target of " << scene.accuracy->request.target_mm
        << " mm: " << scene.accuracy->reason << '\n';
  return out.str();
}

}  // namespace kerf
