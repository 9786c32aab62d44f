// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <optional>
#include <string>
#include <vector>

#include "kernel/sculpture.h"

namespace kerf {

/// How a block is carved: what a scene's "accuracy" comes down to.
struct Accuracy {
  Rays rays = Rays::kDexel;
  double pitch_mm = 0.25;
  double tolerance_mm = 0.01;
  MotionModel motion = MotionModel::kTight;
  friend bool operator==(const Accuracy&, const Accuracy&) = default;
};

/// What a user asks for: a greatest surface error, and any of the four values that must not be
/// chosen.
struct AccuracyRequest {
  double target_mm = 0;
  std::optional<Rays> rays = {};
  std::optional<double> pitch_mm = {}, tolerance_mm = {};
  std::optional<MotionModel> motion = {};
};

/// For what kind of work the accuracy is chosen.
struct AccuracyUse {
  StockShape stock;
  std::vector<Tool> tools;
  bool turns = true;  ///< whether the machine can turn the tool's axis
};

struct AccuracyChoice {
  AccuracyRequest request;
  Accuracy accuracy;
  double predicted_error_mm = 0;  ///< greatest distance of the mesh from the true solid
  double predicted_us = 0;  ///< CPU time of a motion of 1 mm (and 2.5 degrees) on the machine that
                            ///< the law was measured on
  std::string reason;       ///< one line: what was chosen, and why
};

enum class AccuracyErrorCode {
  kUnreachable,    ///< what is fixed is too coarse for the target
  kTooMuchMemory,  ///< the pitch that the target needs would not fit
  kOutOfRange      ///< the pitch or tolerance that the target needs is none that the kernel takes
};
struct AccuracyError {
  AccuracyErrorCode code;
  std::string field;   ///< of "accuracy", that stands in the way, e.g. "pitch_mm"
  std::string reason;  ///< one sentence
};

/// Greatest surface error that is to be expected: the law of server/carve/README.md.
double predicted_error_mm(const Accuracy& accuracy);
/// CPU time of a typical motion by the law of server/carve/README.md, us.
double predicted_us(const Accuracy& accuracy, const AccuracyUse& use);
/// Bytes of the stock if all of it is touched.
double predicted_bytes(const Accuracy& accuracy, const StockShape& stock);

/// The cheapest accuracy whose predicted surface error meets the target, within 4 GiB of stock and
/// fine enough for the smallest tool. Equal requests give equal choices on every machine. Where all
/// four values are given there is nothing to choose and no error: the reason says what to expect.
std::expected<AccuracyChoice, AccuracyError> choose_accuracy(const AccuracyRequest& request,
                                                             const AccuracyUse& use);

}  // namespace kerf
