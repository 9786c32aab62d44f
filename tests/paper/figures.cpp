// SPDX-License-Identifier: Apache-2.0
#include "tests/paper/figures.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "kernel/surface/solid_surface.h"
#include "tests/kernel/extremes/carving.h"
#include "tests/paper/examples.h"
#include "tests/paper/output_checks.h"
#include "tests/paper/volume_checks.h"

namespace kerf::paper {
namespace {

constexpr Vec3 kBlue{0.04, 0.12, 0.7}, kRed{0.7, 0.04, 0.04}, kSteel{0.35, 0.38, 0.42};
constexpr Vec3 kFromFront{-0.25, -1, 0.55}, kFromAboveFront{0, -0.55, 1};

Picture draw(Sculpture& block, PictureStyle style) {
  return render_block(block.snapshot(), style, [](double) {}, {}).value();
}

/// Pictures of equal height in a row.
Picture row_of(const std::vector<Picture>& parts) {
  Picture row{0, parts.front().height, {}};
  for (const Picture& part : parts) row.width += part.width;
  for (int y = 0; y < row.height; ++y) {
    for (const Picture& part : parts) {
      const auto begin = part.rgba.begin() + std::ptrdiff_t{4} * y * part.width;
      row.rgba.insert(row.rgba.end(), begin, begin + std::ptrdiff_t{4} * part.width);
    }
  }
  return row;
}

Picture cropped(const Picture& whole, int left, int top, int width, int height) {
  Picture part{width, height, {}};
  for (int y = top; y < top + height; ++y) {
    const auto begin =
        whole.rgba.begin() + std::ptrdiff_t{4} * (std::ptrdiff_t{y} * whole.width + left);
    part.rgba.insert(part.rgba.end(), begin, begin + std::ptrdiff_t{4} * width);
  }
  return part;
}

void add_arrow(Vec3 from, Vec3 along, double thick, Vec3 color, std::vector<PictureRod>& rods) {
  const double size = length(along), head = std::min(5 * thick, 0.6 * size);
  if (size < thick) return;
  const Vec3 neck = from + along * (1 - head / size);
  rods.push_back({from, neck, thick, thick, color});
  rods.push_back({neck, from + along, 2.4 * thick, 0, color});
}

double radius_of(const Tool& tool, double height_mm) {
  double radius = 0;
  for (const ToolPiece& piece : tool.pieces) radius = std::max(radius, radius_at(piece, height_mm));
  return radius;
}

/// Adds a tool as slices of its height.
void add_tool(const Tool& tool, const ToolPose& pose, double height_mm,
              std::vector<PictureRod>& rods) {
  constexpr int kSlices = 40;
  for (int n = 0; n < kSlices; ++n) {
    // Finer towards the tip.
    const double low = height_mm * n * n / (kSlices * kSlices);
    const double high = height_mm * (n + 1) * (n + 1) / (kSlices * kSlices);
    rods.push_back({pose.tip_mm + pose.axis * low, pose.tip_mm + pose.axis * high,
                    radius_of(tool, low), radius_of(tool, high), kSteel});
  }
}

/// The dexels of Fig. 1, alternately light and dark.
Picture draw_dexel_updates() {
  std::vector<Picture> parts;
  for (const double height : {10.0, 0.0, 5.0}) {
    Sculpture block = columns_cut_at(height);
    PictureStyle style{.width = 230, .height = 200, .towards_eye = {-0.35, -1, 0.5}};
    style.paint = [](Vec3 at) {
      const int odd = (int(std::floor(at.x / 2 + 1e-6)) + int(std::floor(at.y / 2 + 1e-6))) & 1;
      return std::optional(odd != 0 ? Vec3{0.30, 0.16, 0.07} : Vec3{0.70, 0.51, 0.30});
    };
    parts.push_back(draw(block, style));
  }
  return row_of(parts);
}

/// Returns the swept volume as a solid: the hollow that the tool leaves in a block.
Sculpture swept_solid(const Tool& tool, const ToolPose& from, const ToolPose& to, MotionModel model,
                      double tolerance_mm) {
  Sculpture block = Sculpture::create({.stock = BoxStock{{-32, -16, -20}, {32, 16, 30}},
                                       .rays = Rays::kTriDexel,
                                       .tolerance_mm = tolerance_mm,
                                       .motion = model})
                        .value();
  block.apply(DefineTool{1, tool}).value();
  block.apply(MoveTool{1, from, to}).value();
  auto mesh = std::make_shared<TriangleMesh>();
  std::map<std::array<float, 3>, std::uint32_t> places;
  SolidSurface surface(block.solid());
  const Vec3 origin = block.grid().origin_mm;
  for (TileMesh piece; surface.next(piece);) {
    for (std::size_t n = 0; n < piece.indices.size(); n += 3) {
      if (piece.original[piece.indices[n]] != 0) continue;  // the block's outside
      std::array<std::uint32_t, 3> corners{};
      for (std::size_t k = 0; k < 3; ++k) {
        const auto& at = piece.positions_mm[piece.indices[n + k]];
        const auto [place, is_new] = places.emplace(at, mesh->vertices_mm.size());
        if (is_new) mesh->vertices_mm.push_back(origin + Vec3{at[0], at[1], at[2]});
        corners[k] = place->second;
      }
      mesh->triangles.push_back(corners);
    }
  }
  return Sculpture::create({.stock_mesh = mesh, .pitch_mm = 0.1}).value();
}

/// The swept volume: the first pose in blue, the last one in red, and the envelope between them.
Picture draw_sweep(const ToolPose& from, const ToolPose& to,
                   MotionModel model = MotionModel::kTight, double tolerance_mm = 0.01) {
  const Tool tool = make_tool(ConeEndShape{8, 90, 22}).value();
  Sculpture solid = swept_solid(tool, from, to, model, tolerance_mm);
  PictureStyle style{.width = 210, .height = 230, .towards_eye = {-0.25, -1, 0.4}};
  style.paint = [&](Vec3 at) -> std::optional<Vec3> {
    const auto within = [&](const ToolPose& pose) {
      const double h = dot(at - pose.tip_mm, pose.axis);
      const double rho = length(at - pose.tip_mm - pose.axis * h);
      return h > -0.15 && h < 22.15 && rho < radius_of(tool, std::clamp(h, 0.0, 22.0)) + 0.15;
    };
    if (within(to)) return Vec3{0.62, 0.16, 0.12};
    if (within(from)) return Vec3{0.12, 0.25, 0.62};
    return Vec3{0.55, 0.55, 0.5};
  };
  return draw(solid, style);
}

Picture draw_simple_motions() {
  const ToolPose a = test::leaning({0, 0, 0}, 0);
  return row_of({draw_sweep(a, {{0, 0, -9}}),
                 draw_sweep(test::leaning({0, 0, 0}, -0.5), test::leaning({0, 0, 0}, 0.5)),
                 draw_sweep(a, {{14, 0, -4}})});
}

Picture draw_general_motion() {
  const ToolPose from = test::leaning({-9, 0, 0}, -0.35), to = test::leaning({9, 0, -3}, 0.65);
  return row_of({draw_sweep(from, to), draw_sweep(from, to, MotionModel::kPaper, 6),
                 draw_sweep(from, to, MotionModel::kPaper, 2)});
}

Picture draw_bird() {
  const Example one = bird();
  PictureStyle style{.width = 430, .height = 360, .towards_eye = kFromAboveFront};
  const ToolPose& place = one.path[one.path.size() * 5 / 8];
  ToolPose pose = place;
  pose.axis = {0, 0, 1};
  add_tool(make_tool(one.shape).value(), pose, 16, style.rods);
  return draw(carved_bird(), style);
}

Picture draw_bird_stl() {
  Sculpture model = Sculpture::create({.stock_mesh = bird_stl(), .pitch_mm = 0.15}).value();
  PictureStyle style{.width = 1280, .height = 1072, .towards_eye = kFromAboveFront};
  style.paint = [](Vec3) { return std::optional(Vec3{0.45, 0.47, 0.5}); };
  const Picture fine = draw(model, style);
  style.width = 430;
  style.height = 360;
  return row_of({draw(model, style), cropped(fine, 200, 190, 430, 360)});
}

/// Fig. 16: the vectors that are drawn along the path.
Picture draw_curve(bool motion, bool force, bool torque) {
  Example one = curve();
  one.settings.pitch_mm = 0.2;
  Carved carved = carve(one);
  PictureStyle style{.width = 430, .height = 270, .towards_eye = kFromAboveFront};
  double most_n = 0, most_nmm = 0;
  for (const Step& step : carved.steps) {
    most_n = std::max(most_n, length(step.result.wrench.force_n));
    most_nmm = std::max(most_nmm, length(step.result.wrench.torque_nmm));
  }
  constexpr double kLongestMm = 9, kAboveMm = 1.2;
  const Vec3 up{0, 0, kAboveMm};
  for (std::size_t n = 0; n < carved.steps.size(); ++n) {
    const Step& step = carved.steps[n];
    const auto level = [&](Vec3 at) { return Vec3{at.x, at.y, 0} + up; };
    const Vec3 at = level(step.to.tip_mm);
    style.rods.push_back({level(step.from.tip_mm), at, 0.12, 0.12, {0.03, 0.03, 0.03}});
    if (n % 8 != 4) continue;
    const Wrench& wrench = step.result.wrench;
    if (force) add_arrow(at, wrench.force_n * (kLongestMm / most_n), 0.2, kBlue, style.rods);
    if (torque) add_arrow(at, wrench.torque_nmm * (kLongestMm / most_nmm), 0.2, kRed, style.rods);
  }
  if (motion) add_tool(make_tool(one.shape).value(), one.path[150], 14, style.rods);
  return draw(carved.block, style);
}

Picture draw_motion_and_wrench() {
  return row_of({draw_curve(true, false, false), draw_curve(false, true, true)});
}
Picture draw_force_and_torque() {
  return row_of({draw_curve(false, true, false), draw_curve(false, false, true)});
}

Picture draw_brush() {
  const PictureStyle style{.width = 360, .height = 360, .towards_eye = {-0.1, -0.45, 1}};
  Replay& replay = replayed_brush();
  return row_of({draw(replay.by_hand, style), draw(replay.from_nc, style)});
}

Picture draw_furniture() {
  std::size_t spirals = 0;
  const Example one = furniture(&spirals);
  Carved carved = carve(one);
  PictureStyle style{.width = 430, .height = 300, .towards_eye = {-0.2, -0.7, 1}};
  const Picture plain = draw(carved.block, style);
  const std::size_t first = one.path.size() - spirals;
  for (std::size_t n = first; n + 1 < one.path.size(); ++n) {
    const ToolPose &at = one.path[n], &next = one.path[n + 1];
    if (length(next.tip_mm - at.tip_mm) > 2) continue;
    style.rods.push_back({at.tip_mm, next.tip_mm, 0.2, 0.2, kRed});
    style.rods.push_back({at.tip_mm + at.axis * 9, next.tip_mm + next.axis * 9, 0.15, 0.15, kBlue});
    if (n % 8 == 0) style.rods.push_back({at.tip_mm, at.tip_mm + at.axis * 9, 0.12, 0.12, kBlue});
  }
  add_tool(make_tool(one.shape).value(), one.path[first + 200], 24, style.rods);
  return row_of({draw(carved.block, style), plain});
}

}  // namespace

const std::vector<Figure>& figures() {
  static const std::vector<Figure> kFigures{
      {"fig01", "Fig. 1 (c), (d), (e)",
       "Dexels, 2 mm thick, that a lying ball mill shortens at the top, shortens at the bottom, "
       "and "
       "breaks in the middle.",
       draw_dexel_updates},
      {"fig07", "Fig. 7 (a), (b), (d)",
       "Swept volumes of a cone end mill: along its axis, rotating, translating. Blue is the first "
       "pose, red the last one, grey the envelope.",
       draw_simple_motions},
      {"fig08", "Fig. 8 (a), (b)",
       "Translation and rotation at once. Left the true motion (tight model); then the paper's "
       "discretization, with tolerances of 6 and 2 mm, so that its segments are seen.",
       draw_general_motion},
      {"fig15b", "Fig. 15 (a), (b)", "A bird in relief, and the ball mill that carves it.",
       draw_bird},
      {"fig15c", "Fig. 15 (c), (d)",
       "The same, written as STL, read again and rendered; details near its head.", draw_bird_stl},
      {"fig16d", "Fig. 16 (c), (d)",
       "A ball mill on a curved path, and the force (blue) and torque (red) along it, drawn above "
       "the "
       "block.",
       draw_motion_and_wrench},
      {"fig16e", "Fig. 16 (e), (f)",
       "The force alone, which follows the tangent backwards, and the torque alone, at right "
       "angles "
       "to it. The longest arrow of each is its greatest value.",
       draw_force_and_torque},
      {"fig17", "Fig. 17 (a), (b), (c)",
       "A character by a brush (a leaning cone): as sculpted, and carved again from its NC "
       "program.",
       draw_brush},
      {"fig18", "Fig. 18 (a), (b), (c)",
       "A furniture surface in five axes: the tool, its path (red) and its axis (blue) along the "
       "spirals; the dexel model.",
       draw_furniture}};
  return kFigures;
}

}  // namespace kerf::paper
