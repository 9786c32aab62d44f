// SPDX-License-Identifier: Apache-2.0
#include "server/formats/accuracy_choice.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "kernel/dexel/stock_column.h"
#include "server/formats/number_text.h"

namespace kerf {
namespace {

// The error and cost models that server/carve/README.md derives from measurements. They use
// + - * / and square roots only, so equal scenes give equal choices on every CPU.

// Greatest distance between the mesh and the true solid, in pitches. With rays along Z alone it
// occurs at steep walls and their edges, with three fields at features smaller than the pitch.
constexpr double kErrorPerPitchDexel = 0.9, kErrorPerPitchTriDexel = 0.75;
// Exception from the true solid to the mesh, which may lack such features.
constexpr const char* kExcept =
    "; more where a wall or groove is thinner than the pitch or an edge sharper than 80 degrees";
// Contribution of the errors of dexel ends and arc chords, in tolerances.
constexpr double kErrorPerTolerance = 1;
// CPU time of a motion of 1 mm with a turn of 2.5 degrees, forces included, us: per sub-motion, per
// row of columns under the tool (the square root of their number) and per column.
constexpr double kUsPerSubMotion = 6;
constexpr double kUsPerRow = 0.23;
constexpr double kUsPerColumn = 0.0032;
// Cost of all sub-motions relative to one: 1 + kTightParts / sqrt(tolerance) for the tight model,
// 1 + kPaperParts / tolerance for the paper's (tolerance in mm).
constexpr double kTightParts = 0.0017;
constexpr double kPaperParts = 0.3;
// Cost of three fields of rays relative to one.
constexpr double kTriDexelCost = 4.8;
// Length of the motion whose footprint determines the number of columns, mm.
constexpr double kTravelMm = 1;

// CPU time of meshing the tiles of a block for a new page, us per column of the field along Z, the
// only field that pages see.
constexpr double kJoinUsPerColumn = 1.7;

constexpr double kBytesMax = 4.0 * 1024 * 1024 * 1024;
constexpr double kBytesPerColumn = 8.3;
// Fewest pitches per tool radius. Below this, cuts fall between the rays.
constexpr double kPitchesPerRadius = 1;
// Share of the target given to the tolerance: the minimum of the product of columns (1 / pitch^2)
// and sub-motions. The shares are constant, so that a smaller target never gets a coarser pitch.
// Without rotary axes the tolerance only determines the number of chords of arcs.
constexpr double kTightShare = 0.1, kPaperShare = 0.3, kUprightShare = 0.02;
// The same limits as Sculpture::create.
constexpr double kPitchMinMm = 1e-4, kPitchMaxMm = 1000;
constexpr double kToleranceMinMm = 1e-6;

// Relative. A value this little below a short decimal is that decimal. It covers the rounding of
// doubles: 0.9 · 0.3 + 0.03 exceeds 0.3 in the last bit. If it grows, a target may be missed by it.
constexpr double kRounding = 1e-12;

// Returns whether an expected error exceeds the target by more than the rounding of pitch and
// tolerance.
bool misses(double error_mm, double target_mm) {
  return error_mm > target_mm * (1 + 2 * kRounding);
}

// Rounds down to `digits` significant digits, so that the chosen settings are readable.
double rounded_down(double value, int digits) {
  double unit = 1;
  int exponent = 0;
  const double limit = digits == 3 ? 1000 : 100;
  for (; value / unit >= limit; ++exponent) unit *= 10;
  for (; value / unit < limit / 10; --exponent) unit /= 10;
  const auto whole = static_cast<long>(value / unit * (1 + kRounding));
  const std::string text = std::to_string(whole) + "e" + std::to_string(exponent);
  double result = value;
  std::from_chars(text.data(), text.data() + text.size(), result);
  return result;
}

double smallest_radius_mm(const std::vector<Tool>& tools) {
  double radius = kPitchMaxMm;
  for (const Tool& tool : tools) radius = std::min(radius, tool.radius_mm);
  return radius;
}

double largest_radius_mm(const std::vector<Tool>& tools) {
  double radius = 0;
  for (const Tool& tool : tools) radius = std::max(radius, tool.radius_mm);
  return radius;
}

// Coarsest pitch at which neither a cut nor a wall falls between the rays.
double coarsest_pitch_mm(const AccuracyUse& use) {
  double pitch = std::min(smallest_radius_mm(use.tools) / kPitchesPerRadius, kPitchMaxMm);
  return std::min(pitch, use.wall_pitch_mm.value_or(pitch));
}

double error_per_pitch(Rays rays) {
  return rays == Rays::kTriDexel ? kErrorPerPitchTriDexel : kErrorPerPitchDexel;
}

// Number of fields of rays.
int fields(Rays rays) { return rays == Rays::kTriDexel ? 3 : 1; }

std::string mm(double value) { return significant_text(value, 3) + " mm"; }

// Returns an error with as many digits as distinguish it from the target, at least 3.
std::string error_text(double error_mm, double target_mm) {
  int digits = 3;
  const auto same = [&] {
    return significant_text(error_mm, digits) == significant_text(target_mm, digits);
  };
  while (digits < 15 && same()) ++digits;
  return significant_text(error_mm, digits) + " mm";
}

// Coarsest pitch whose error and that of the tolerance together meet the target.
double pitch_for(double target_mm, double tolerance_mm, Rays rays) {
  return (target_mm - kErrorPerTolerance * tolerance_mm) / error_per_pitch(rays);
}

std::unexpected<AccuracyError> failure(AccuracyErrorCode code, std::string field,
                                       std::string reason) {
  return std::unexpected(AccuracyError{code, std::move(field), std::move(reason)});
}

double share_of(MotionModel motion, bool turns) {
  if (!turns) return kUprightShare;
  return motion == MotionModel::kTight ? kTightShare : kPaperShare;
}

// Returns an error if no choice of the remaining values meets the target with these rays.
std::expected<void, AccuracyError> check(const AccuracyRequest& r, const AccuracyUse& use,
                                         Rays rays) {
  using enum AccuracyErrorCode;
  const double tolerance = r.tolerance_mm.value_or(0);
  const double per_pitch = error_per_pitch(rays);
  if (kErrorPerTolerance * tolerance >= r.target_mm)
    return failure(kUnreachable, "tolerance_mm",
                   "is " + mm(tolerance) + "; it must be below the target of " + mm(r.target_mm));
  const double expected_mm = per_pitch * r.pitch_mm.value_or(0) + kErrorPerTolerance * tolerance;
  if (misses(expected_mm, r.target_mm))
    return failure(kUnreachable, "pitch_mm",
                   "is " + mm(*r.pitch_mm) + ", with which a surface error of " +
                       error_text(expected_mm, r.target_mm) +
                       " is expected, more than the target of " + mm(r.target_mm) +
                       "; reduce the pitch or raise the target");
  if (r.pitch_mm && use.wall_pitch_mm && *r.pitch_mm > *use.wall_pitch_mm)
    return failure(kUnreachable, "pitch_mm",
                   "is " + mm(*r.pitch_mm) + "; thin walls of the program need at most " +
                       mm(*use.wall_pitch_mm));
  if (!r.tolerance_mm && expected_mm >= r.target_mm)
    return failure(kUnreachable, "pitch_mm",
                   "is " + mm(*r.pitch_mm) + ", which leaves nothing of the target of " +
                       mm(r.target_mm) +
                       " for the tolerance; reduce the pitch or raise the target");
  const double share =
      r.tolerance_mm ? 0 : share_of(r.motion.value_or(MotionModel::kTight), use.turns);
  const double pitch = r.pitch_mm.value_or(std::min(
      pitch_for(r.target_mm, tolerance + share * r.target_mm, rays), coarsest_pitch_mm(use)));
  const double least_tolerance = r.tolerance_mm.value_or(
      (r.target_mm - per_pitch * r.pitch_mm.value_or(0)) / kErrorPerTolerance / 2);
  if (pitch < kPitchMinMm || least_tolerance < kToleranceMinMm)
    return failure(kOutOfRange, "target_mm",
                   "is " + mm(r.target_mm) + ", for which the pitch would have to be " + mm(pitch) +
                       "; the smallest pitch is " + mm(kPitchMinMm));
  Accuracy finest{rays, pitch, tolerance, MotionModel::kTight};
  const double bytes = predicted_bytes(finest, use.stock);
  if (bytes > kBytesMax) {
    finest.pitch_mm = pitch * std::sqrt(bytes / kBytesMax);
    return failure(kTooMuchMemory, "target_mm",
                   "is " + mm(r.target_mm) + ", for which this stock may need " +
                       significant_text(bytes / kBytesMax * 4, 3) +
                       " GiB; the limit is 4 GiB, which allows a target of " +
                       mm(predicted_error_mm(finest) / (1 - share)));
  }
  return {};
}

// Returns the cheapest accuracy for given rays and motion model. Precondition: check() passed.
Accuracy cheapest(const AccuracyRequest& r, const AccuracyUse& use, Rays rays, MotionModel motion) {
  const double coarsest = coarsest_pitch_mm(use);
  // With a fixed pitch the tolerance gets half of the remaining error.
  const double remaining_mm = r.pitch_mm ? (r.target_mm - error_per_pitch(rays) * *r.pitch_mm) / 2
                                         : share_of(motion, use.turns) * r.target_mm;
  const double tolerance = r.tolerance_mm.value_or(remaining_mm / kErrorPerTolerance);
  const double pitch = r.pitch_mm.value_or(
      rounded_down(std::min(pitch_for(r.target_mm, tolerance, rays), coarsest), 3));
  return {rays, pitch, r.tolerance_mm.value_or(rounded_down(tolerance, 2)), motion};
}

bool all_given(const AccuracyRequest& r) {
  return r.rays && r.pitch_mm && r.tolerance_mm && r.motion;
}

std::string reason_text(const AccuracyChoice& choice, const AccuracyUse& use) {
  const AccuracyRequest& r = choice.request;
  const Accuracy& a = choice.accuracy;
  const auto given = [&r](bool fixed) { return fixed && !all_given(r) ? " (given)" : ""; };
  std::string text = std::string(to_string(a.rays)) + given(r.rays.has_value()) + ", pitch " +
                     exact_text(a.pitch_mm) + " mm" + given(r.pitch_mm.has_value()) +
                     ", tolerance " + exact_text(a.tolerance_mm) + " mm" +
                     given(r.tolerance_mm.has_value()) + ", " +
                     (a.motion == MotionModel::kTight ? "tight" : "paper") +
                     given(r.motion.has_value()) + ": expected surface error " +
                     (misses(choice.predicted_error_mm, r.target_mm)
                          ? error_text(choice.predicted_error_mm, r.target_mm)
                          : mm(choice.predicted_error_mm));
  if (misses(choice.predicted_error_mm, r.target_mm))
    return text + ", which misses the target of " + mm(r.target_mm);
  text += " (" + exact_text(error_per_pitch(a.rays)) + " pitch + tolerance" + kExcept + ")";
  if (!r.pitch_mm && a.pitch_mm >= use.wall_pitch_mm.value_or(kPitchMaxMm) * 0.99)
    text += "; the pitch is limited by thin walls of the program";
  else if (!r.pitch_mm && a.pitch_mm * kPitchesPerRadius >= smallest_radius_mm(use.tools) * 0.99)
    text += "; the pitch is limited by the radius of the smallest tool";
  const auto times = [&](const Accuracy& other) {
    return significant_text(predicted_us(other, use) / choice.predicted_us, 2) + " times as long";
  };
  const bool one_field = a.rays == Rays::kDexel;
  if (!r.rays && check(r, use, one_field ? Rays::kTriDexel : Rays::kDexel))
    text +=
        (one_field ? "; three fields of rays would take " : "; rays along Z alone would take ") +
        times(cheapest(r, use, one_field ? Rays::kTriDexel : Rays::kDexel, a.motion));
  if (!r.motion) {
    Accuracy paper = a;
    paper.motion = MotionModel::kPaper;
    if (use.turns) text += "; the paper's motion model would take " + times(paper);
  }
  return text;
}

}  // namespace

double predicted_error_mm(const Accuracy& a) {
  return error_per_pitch(a.rays) * a.pitch_mm + kErrorPerTolerance * a.tolerance_mm;
}

double predicted_us(const Accuracy& a, const AccuracyUse& use) {
  const double r = largest_radius_mm(use.tools);
  const double columns = 2 * r * (2 * r + kTravelMm) / (a.pitch_mm * a.pitch_mm);
  double parts = 1;
  if (use.turns && a.motion == MotionModel::kTight)
    parts += kTightParts / std::sqrt(a.tolerance_mm);
  if (use.turns && a.motion == MotionModel::kPaper) parts += kPaperParts / a.tolerance_mm;
  const double one_field =
      parts * (kUsPerSubMotion + kUsPerRow * std::sqrt(columns) + kUsPerColumn * columns);
  return a.rays == Rays::kTriDexel ? kTriDexelCost * one_field : one_field;
}

double predicted_bytes(const Accuracy& a, const StockShape& stock) {
  const DexelGrid grid = make_grid(stock, std::max(a.pitch_mm, kPitchMinMm));
  const double x = grid.columns_x, y = grid.columns_y;
  if (fields(a.rays) == 1) return kBytesPerColumn * x * y;
  const double z = double(grid.height_quanta) * grid.z_quantum_mm / a.pitch_mm;
  return kBytesPerColumn * (x * y + y * z + z * x);
}

double predicted_join_s(const Accuracy& a, const StockShape& stock) {
  const DexelGrid grid = make_grid(stock, std::max(a.pitch_mm, kPitchMinMm));
  return 1e-6 * kJoinUsPerColumn * double(grid.columns_x) * double(grid.columns_y);
}

std::expected<AccuracyChoice, AccuracyError> choose_accuracy(const AccuracyRequest& r,
                                                             const AccuracyUse& use) {
  AccuracyChoice choice{.request = r, .accuracy = {}, .reason = {}};
  if (all_given(r)) {
    choice.accuracy = {*r.rays, *r.pitch_mm, *r.tolerance_mm, *r.motion};
  } else {
    std::optional<AccuracyError> first_error;
    bool found = false;
    for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
      if (r.rays.value_or(rays) != rays) continue;
      if (auto possible = check(r, use, rays); !possible) {
        first_error = first_error.value_or(possible.error());
        continue;
      }
      for (const MotionModel motion : {MotionModel::kTight, MotionModel::kPaper}) {
        if (r.motion.value_or(motion) != motion) continue;
        const Accuracy one = cheapest(r, use, rays, motion);
        if (!found || predicted_us(one, use) < predicted_us(choice.accuracy, use))
          choice.accuracy = one;
        found = true;
      }
    }
    if (!found) return std::unexpected(*first_error);
  }
  choice.predicted_error_mm = predicted_error_mm(choice.accuracy);
  choice.predicted_us = predicted_us(choice.accuracy, use);
  choice.reason = reason_text(choice, use);
  return choice;
}

}  // namespace kerf
