// SPDX-License-Identifier: Apache-2.0
#include "kernel/force/body_contact.h"

#include "tests/support/test.h"

namespace kerf::body_contact_test {
namespace {

constexpr double kStiffness = 3;
const Vec3 kUp{0, 0, 1};

ContactPlane plane(Vec3 normal, double depth_mm) {
  return {.point_mm = {}, .normal = normal, .depth_mm = depth_mm, .stiffness_n_per_mm = kStiffness};
}

BodyContact contact_of(const std::vector<ContactPlane>& planes) {
  BodyContact contact;
  for (const ContactPlane& p : planes) contact.add(p);
  return contact;
}

Vec3 push(const std::vector<ContactPlane>& planes) {
  BodyContact contact = contact_of(planes);
  return wrench_of(contact.shared(), {{}, kUp}, 0).force_n;
}

TEST(BodyContact, OnePartIsPushedByStiffnessTimesDepth) {
  EXPECT_EQ(push({plane(kUp, 0.5)}), (Vec3{0, 0, 1.5}));
}

TEST(BodyContact, PartsPushedInOneDirectionShareThePushOfTheDeepest) {
  BodyContact contact = contact_of({plane(kUp, 1), plane(kUp, 0.5), plane(kUp, 0.25)});
  const auto shared = contact.shared();
  ASSERT_EQ(shared.size(), 3U);
  double sum_n = 0;
  for (const ContactPlane& p : shared) {
    const double push_n = p.stiffness_n_per_mm * p.depth_mm;
    sum_n += push_n;
    // In proportion to the squares of the depths, 16 : 4 : 1.
    EXPECT_NEAR(push_n, kStiffness * p.depth_mm * p.depth_mm * 16 / 21, 1e-12);
  }
  EXPECT_NEAR(sum_n, kStiffness, 1e-12);
}

TEST(BodyContact, PartsPushedAtRightAnglesOrApartDoNotAffectEachOther) {
  const Vec3 f = push({plane(kUp, 1), plane({1, 0, 0}, 0.5), plane({0, -1, 0}, 0.25)});
  EXPECT_NEAR(length(f - Vec3{1.5, -0.75, 3}), 0, 1e-12);
  const Vec3 apart = push({plane(kUp, 1), plane(-kUp, 0.75)});
  EXPECT_NEAR(length(apart - Vec3{0, 0, 0.75}), 0, 1e-12);
}

TEST(BodyContact, EqualDepthsAtAnAnglePushEachPartOutByItsDepth) {
  for (const double angle : {0.1, 0.5, 1.0, 1.5}) {
    const Vec3 a{std::sin(angle / 2), 0, std::cos(angle / 2)}, b{-a.x, 0, a.z};
    const Vec3 f = push({plane(a, 0.4), plane(b, 0.4)});
    EXPECT_NEAR(dot(f, a), kStiffness * 0.4, 1e-12) << angle;
    EXPECT_NEAR(dot(f, b), kStiffness * 0.4, 1e-12) << angle;
  }
}

TEST(BodyContact, NewContactsChangeThePushContinuously) {
  const Vec3 aside = normalized({1, 0, 2});
  const Vec3 before = push({plane(kUp, 1)});
  for (const double depth : {0.0, 1e-9, 1e-6}) {
    EXPECT_LT(length(push({plane(kUp, 1), plane(aside, depth)}) - before), 4 * depth + 1e-12);
  }
}

TEST(BodyContact, GapsKeepTheStiffnessAndPushNothing) {
  BodyContact contact = contact_of({plane(kUp, 1), plane(kUp, -2)});
  const auto shared = contact.shared();
  EXPECT_EQ(shared[0].stiffness_n_per_mm, kStiffness);
  EXPECT_EQ(shared[1].stiffness_n_per_mm, kStiffness);
  EXPECT_EQ(push({plane(kUp, 1), plane(kUp, -2)}), (Vec3{0, 0, 3}));
}

TEST(BodyContact, KeepsTheDeepestPlanes) {
  BodyContact contact;
  for (int n = 1; n <= 24; ++n) contact.add(plane(kUp, n % 2 == 0 ? n : 25 - n));
  const auto shared = contact.shared();
  ASSERT_EQ(shared.size(), BodyContact::kPlanesMax);
  for (const ContactPlane& p : shared) EXPECT_GT(p.depth_mm, 8);
}

TEST(BodyContact, RepeatedQueriesReturnEqualShares) {
  BodyContact contact = contact_of({plane(kUp, 1), plane(kUp, 1)});
  EXPECT_EQ(contact.shared()[0].stiffness_n_per_mm, kStiffness / 2);
  EXPECT_EQ(contact.shared()[0].stiffness_n_per_mm, kStiffness / 2);
  contact.add(plane(kUp, 1));
  EXPECT_EQ(contact.shared()[0].stiffness_n_per_mm, kStiffness / 3);
}

}  // namespace
}  // namespace kerf::body_contact_test
