// SPDX-License-Identifier: Apache-2.0
#include "kernel/math/quadratic.h"

#include "tests/support/test.h"

namespace kerf::quadratic_test {
namespace {

TEST(Quadratic, OrdersItsRoots) {
  const QuadraticRoots<double> r = solve_quadratic<double>(2, -3, 4);  // 2 t^2 - 6 t + 4
  EXPECT_DOUBLE_EQ(r.first, 1);
  EXPECT_DOUBLE_EQ(r.second, 2);
  const QuadraticRoots<double> mirrored = solve_quadratic<double>(-2, 3, -4);
  EXPECT_DOUBLE_EQ(mirrored.first, 1);
  EXPECT_DOUBLE_EQ(mirrored.second, 2);
}

TEST(Quadratic, SmallRootIsExactDespiteCancellation) {
  const QuadraticRoots<double> r = solve_quadratic<double>(1, -0.5e8, 1);  // roots 1e-8 and 1e8
  EXPECT_NEAR(r.first / 1e-8, 1, 1e-15);
  EXPECT_NEAR(r.second / 1e8, 1, 1e-15);
}

TEST(Quadratic, VanishingLeadingCoefficientGivesTheLinearRoot) {
  for (const double sign : {1.0, -1.0}) {
    const QuadraticRoots<double> r = solve_quadratic<double>(0, sign * 2, -sign * 12);  // 4 t - 12
    EXPECT_TRUE(r.first == 3 || r.second == 3);
    EXPECT_TRUE(std::isinf(r.first) || std::isinf(r.second));
  }
}

TEST(Quadratic, NoRealRootGivesNaN) {
  const QuadraticRoots<double> r = solve_quadratic<double>(1, 0, 1);
  EXPECT_FALSE(r.first <= 0 || r.first >= 0);
  EXPECT_FALSE(r.second <= 0 || r.second >= 0);
}

TEST(Quadratic, DoubleRootAtZero) {
  const QuadraticRoots<double> r = solve_quadratic<double>(3, 0, 0);
  EXPECT_EQ(r.first, 0);
  EXPECT_EQ(r.second, 0);
}

}  // namespace
}  // namespace kerf::quadratic_test
