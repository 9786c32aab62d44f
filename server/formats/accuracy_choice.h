// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <optional>
#include <string>
#include <vector>

#include "kernel/sculpture.h"

namespace kerf {

/// The resolution at which a block is carved: the "accuracy" object of a scene.
struct Accuracy {
  Rays rays = Rays::kDexel;    ///< one field of rays along Z, or three along X, Y and Z
  double pitch_mm = 0.25;      ///< distance between neighboring rays, 1e-4 to 1000
  double tolerance_mm = 0.01;  ///< greatest error of a dexel end and of an arc's chord, >= 1e-6
  MotionModel motion = MotionModel::kTight;
  friend bool operator==(const Accuracy&, const Accuracy&) = default;
};

/// A requested surface error, with any of the four accuracy values fixed by the user.
struct AccuracyRequest {
  double target_mm = 0;  ///< greatest predicted_error_mm allowed, > 0
  std::optional<Rays> rays = {};
  std::optional<double> pitch_mm = {}, tolerance_mm = {};
  std::optional<MotionModel> motion = {};
};

/// The stock, tools and machine that the accuracy is chosen for.
struct AccuracyUse {
  StockShape stock;
  std::vector<Tool> tools;  ///< at least one
  bool turns = true;        ///< the machine can turn the tool axis
  /// Coarsest pitch at which the thin walls of a program are kept, mm, or empty if no program is
  /// known.
  std::optional<double> wall_pitch_mm = {};
};

/// The result of choose_accuracy.
struct AccuracyChoice {
  AccuracyRequest request;
  Accuracy accuracy;
  /// Greatest distance from the mesh to the true solid. Also from the solid to the mesh, where
  /// walls and grooves are at least a pitch wide and edges at least 80 degrees.
  double predicted_error_mm = 0;
  double predicted_us = 0;  ///< CPU time of a motion of 1 mm (and 2.5 degrees) on the machine on
                            ///< which the cost model was measured
  std::string reason;       ///< one line: the values chosen, the expected error and alternatives
};

/// Why no accuracy meets a target.
enum class AccuracyErrorCode {
  kUnreachable,    ///< a fixed value is too coarse for the target
  kTooMuchMemory,  ///< the pitch that the target requires exceeds 4 GiB of stock
  kOutOfRange      ///< the pitch or tolerance that the target requires is below the kernel's limits
};
struct AccuracyError {
  AccuracyErrorCode code;
  std::string field;   ///< the field of "accuracy" to change, e.g. "pitch_mm"
  std::string reason;  ///< one clause about that field
};

/// Returns AccuracyChoice::predicted_error_mm by the error model of server/carve/README.md.
double predicted_error_mm(const Accuracy& accuracy);
/// Returns the CPU time of a typical motion, us, by the cost model of server/carve/README.md.
double predicted_us(const Accuracy& accuracy, const AccuracyUse& use);
/// Returns the size of the stock in memory if all of it has been touched, bytes.
double predicted_bytes(const Accuracy& accuracy, const StockShape& stock);
/// Returns the CPU time that the server takes to mesh the block for a page that joins when all of
/// it has been touched and no other page has its tiles yet, s, by the cost model of
/// server/carve/README.md. Transfer and the page's own work are not included.
double predicted_join_s(const Accuracy& accuracy, const StockShape& stock);

/// Chooses the cheapest accuracy whose predicted surface error meets the target, with at most 4 GiB
/// of stock and a pitch no larger than the radius of the smallest tool and wall_pitch_mm. Computes
/// with + - × / and square roots only, so equal requests give equal choices on every CPU. A request
/// that fixes all four values always succeeds. `reason` then reports the expected error.
std::expected<AccuracyChoice, AccuracyError> choose_accuracy(const AccuracyRequest& request,
                                                             const AccuracyUse& use);

}  // namespace kerf
