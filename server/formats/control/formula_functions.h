// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "server/formats/units.h"

namespace kerf::formula {

// Operators and functions that the controls have in common. Angles are in degrees.

inline double plus(double a, double b) { return a + b; }
inline double minus(double a, double b) { return a - b; }
inline double times(double a, double b) { return a * b; }
inline double over(double a, double b) { return a / b; }

inline double sine(double deg) { return std::sin(kRadPerDeg * deg); }
inline double cosine(double deg) { return std::cos(kRadPerDeg * deg); }
inline double tangent(double deg) { return std::tan(kRadPerDeg * deg); }
inline double arc_sine(double x) { return kDegPerRad * std::asin(x); }
inline double arc_cosine(double x) { return kDegPerRad * std::acos(x); }
inline double square_root(double x) { return std::sqrt(x); }
inline double magnitude(double x) { return std::abs(x); }
inline double truncated(double x) { return std::trunc(x); }
inline double exponential(double x) { return std::exp(x); }
inline double logarithm(double x) { return std::log(x); }

}  // namespace kerf::formula
