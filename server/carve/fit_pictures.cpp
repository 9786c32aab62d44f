// SPDX-License-Identifier: Apache-2.0
#include "server/carve/fit_pictures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "server/picture/png_file.h"

namespace kerf {
namespace {

constexpr int kPictureWidth = 480, kPictureHeight = 360;
// The colors of a deviation (deviation.cpp), linear.
constexpr Vec3 kTooDeep{0.015, 0.133, 0.413}, kLeftOver{0.445, 0.009, 0.024};
/// A misfit just beyond the tolerance must be visible.
constexpr double kLeastShare = 0.35;
constexpr Vec3 kPale{0.6, 0.6, 0.6};

std::optional<Vec3> misfit_color(double misfit_mm, double tolerance_mm) {
  const double beyond = std::abs(misfit_mm) - tolerance_mm;
  if (beyond <= 0) return std::nullopt;
  const double range = (kFullColorTolerances - 1) * tolerance_mm;
  const double share = std::clamp(beyond / range, kLeastShare, 1.0);
  const Vec3 full = misfit_mm < 0 ? kTooDeep : kLeftOver;
  return kPale + (full - kPale) * share;
}

}  // namespace

std::vector<FitPicture> fit_pictures(const DexelSnapshot& block, const MeshDistance& part,
                                     double tolerance_mm, Workers& workers,
                                     const std::stop_token& stop) {
  constexpr std::array<std::pair<const char*, Vec3>, 3> kSides{
      {{"from the front left", kFromFrontLeft},
       {"from the back right", kFromBackRight},
       {"from above", kFromAbove}}};
  std::array<std::string, kSides.size()> pngs;
  workers.run(static_cast<int>(kSides.size()), [&](int job) {
    const auto side = static_cast<std::size_t>(job);
    PictureStyle style{
        .width = kPictureWidth, .height = kPictureHeight, .towards_eye = kSides[side].second};
    style.paint = [&, near = std::uint32_t{0}](Vec3 at) mutable {
      return misfit_color(part.signed_distance_mm(at, near), tolerance_mm);
    };
    const auto picture = render_block(block, style, [](double) {}, stop);
    if (!picture) return;
    pngs[side] = png_bytes(*picture).value_or(std::string());
  });
  std::vector<FitPicture> pictures;
  for (std::size_t side = 0; side < kSides.size(); ++side)
    if (!pngs[side].empty()) pictures.push_back({kSides[side].first, std::move(pngs[side])});
  return pictures;
}

}  // namespace kerf
