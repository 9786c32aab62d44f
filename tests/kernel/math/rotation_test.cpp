// SPDX-License-Identifier: Apache-2.0
#include "kernel/math/rotation.h"

#include "tests/support/test.h"

namespace kerf::rotation_test {
namespace {

Vec3 random_unit(std::mt19937& random) {
  std::normal_distribution<double> n;
  return normalized({n(random), n(random), n(random)});
}

TEST(Rotation, SineAndCosineMatchLibm) {
  for (double a = -3.14; a <= 3.14; a += 0.0137) {
    EXPECT_NEAR(sin_cos(a).sin, std::sin(a), 2e-15) << a;
    EXPECT_NEAR(sin_cos(a).cos, std::cos(a), 2e-15) << a;
  }
}

TEST(Rotation, AngleIsAccurateFromTinyToPi) {
  std::mt19937 random(3);
  for (const double angle : {1e-12, 1e-9, 1e-4, 0.3, 1.0, 1.5707963, 2.5, 2.96, 3.1}) {
    const Vec3 a = random_unit(random);
    const Vec3 side = normalized(cross(a, random_unit(random)));
    const Vec3 b = a * std::cos(angle) + side * std::sin(angle);
    EXPECT_NEAR(angle_between(a, b), angle, 3e-16 + 1e-14 * angle) << angle;
  }
}

TEST(Rotation, GreatCircleIsUniformAndEndsExactly) {
  std::mt19937 random(5);
  for (int i = 0; i < 200; ++i) {
    const Vec3 a = random_unit(random), b = random_unit(random);
    const double angle = angle_between(a, b);
    EXPECT_EQ(great_circle(a, b, angle, 0), a);
    EXPECT_EQ(great_circle(a, b, angle, 1), b);
    for (const double share : {0.1, 0.5, 0.77}) {
      const Vec3 u = great_circle(a, b, angle, share);
      EXPECT_NEAR(length(u), 1, 1e-15);
      EXPECT_NEAR(angle_between(a, u), share * angle, 1e-14);
      EXPECT_NEAR(angle_between(u, b), (1 - share) * angle, 1e-14);
    }
  }
}

}  // namespace
}  // namespace kerf::rotation_test
