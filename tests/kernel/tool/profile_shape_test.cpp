// SPDX-License-Identifier: Apache-2.0
#include "kernel/tool/tool.h"
#include "tests/support/test.h"
#include "tests/support/tool_profile.h"

namespace kerf::profile_shape_test {
namespace {

using enum ArcBulge;

ProfileStep to(double r, double h) { return ProfilePoint{r, h}; }
ProfileStep arc(double r, double h, double radius, ArcBulge bulge = kOut) {
  return ProfileArc{{r, h}, radius, bulge};
}

TEST(ProfileShape, PlainShapesAreProfiles) {
  EXPECT_EQ(*make_tool(ProfileShape{{to(0, 0), to(5, 0), to(5, 50)}}),
            *make_tool(FlatShape{10, 50}));
  EXPECT_EQ(*make_tool(ProfileShape{{to(5, 0), to(5, 50)}}), *make_tool(FlatShape{10, 50}));
  EXPECT_EQ(*make_tool(ProfileShape{{to(0, 0), arc(5, 5, 5), to(5, 50)}}),
            *make_tool(BallShape{10, 50}));
  const Tool bull = *make_tool(ProfileShape{{to(3, 0), arc(5, 2, 2), to(5, 50)}});
  const auto corner = std::get<ArcPiece>(bull.pieces[0]);
  EXPECT_NEAR(corner.center_r_mm, 3, 1e-12);
  EXPECT_NEAR(corner.center_z_mm, 2, 1e-12);
  EXPECT_NEAR(corner.radius_mm, 2, 1e-12);
  EXPECT_EQ(bull.pieces[1], make_tool(BullNoseShape{10, 2, 50})->pieces[1]);
}

TEST(ProfileShape, LollipopIsABallAndANeck) {
  // A ball of radius 5, a neck of radius 3 that leaves it at the height 9.
  const Tool t = *make_tool(ProfileShape{{to(0, 0), arc(5, 5, 5), arc(3, 9, 5), to(3, 40)}});
  ASSERT_EQ(t.pieces.size(), 3u);  // The outline has two arcs that meet at the equator.
  const Tool one =
      *make_tool(ProfileShape{{to(0, 0), ProfileCenteredArc{{3, 9}, {0, 5}, kOut}, to(3, 40)}});
  ASSERT_EQ(one.pieces.size(), 2u);
  EXPECT_EQ(std::get<BallPiece>(one.pieces[0]), (BallPiece{5, 5}));
  EXPECT_EQ(std::get<FrustumPiece>(one.pieces[1]), (FrustumPiece{9, 3, 40, 3}));
  for (double h = 0.05; h < 40; h += 0.1) {
    EXPECT_NEAR(test::radius_at(t.pieces, h), test::radius_at(one.pieces, h), 1e-12) << h;
  }
}

TEST(ProfileShape, BallNotCoveredByTheNextSectionIsCutOff) {
  // The neck narrows to a point below the ball's top: no whole ball.
  const Tool t =
      *make_tool(ProfileShape{{to(0, 0), ProfileCenteredArc{{3, 9}, {0, 5}, kOut}, to(0, 9.5)}});
  EXPECT_TRUE(std::holds_alternative<ArcPiece>(t.pieces[0]));
  EXPECT_EQ(t.length_mm, 9.5);
}

TEST(ProfileShape, DovetailAndTSlotHaveShoulders) {
  const Tool dovetail = *make_tool(ProfileShape{{to(10, 0), to(5, 8), to(4, 8), to(4, 40)}});
  ASSERT_EQ(dovetail.pieces.size(), 2u);
  EXPECT_EQ(std::get<FrustumPiece>(dovetail.pieces[0]), (FrustumPiece{0, 10, 8, 5}));
  EXPECT_EQ(std::get<FrustumPiece>(dovetail.pieces[1]), (FrustumPiece{8, 4, 40, 4}));
  const Tool slot = *make_tool(ProfileShape{{to(0, 0), to(12, 0), to(12, 6), to(5, 6), to(5, 40)}});
  EXPECT_NEAR(test::volume(slot.pieces, 40), M_PI * (144 * 6 + 25 * 34), 0.05);
}

TEST(ProfileShape, LollipopHasTheVolumeOfBallAndNeck) {
  const Tool t =
      *make_tool(ProfileShape{{to(0, 0), ProfileCenteredArc{{3, 9}, {0, 5}, kOut}, to(3, 40)}});
  // The ball without the cap above 9 (height 1), and the neck from there.
  const double ball = M_PI * (4.0 / 3 * 125 - 1.0 / 3 * (15 - 1));
  EXPECT_NEAR(test::volume(t.pieces, 40), ball + M_PI * 9 * 31, 1e-2);
}

TEST(ProfileShape, BarrelWithPointedEndsIsOneArc) {
  // A lens of radius 10 about (-6, 8): on the axis at 0 and 16.
  const Tool t = *make_tool(ProfileShape{{to(0, 0), arc(0, 16, 10)}});
  ASSERT_EQ(t.pieces.size(), 1u);
  const auto lens = std::get<ArcPiece>(t.pieces[0]);
  EXPECT_NEAR(lens.center_r_mm, -6, 1e-12);
  EXPECT_NEAR(lens.center_z_mm, 8, 1e-12);
  EXPECT_NEAR(t.radius_mm, 4, 1e-12);
}

TEST(ProfileShape, CornerRounderStaysInsideItsFilletByTheChordTolerance) {
  for (const double tolerance : {1e-2, 1e-4, 1e-5}) {
    // A quarter fillet of radius 4 about (8, 2), from a neck of 4 up to a shoulder at 6.
    const ProfileShape shape{{to(4, 0), to(4, 2), arc(8, 6, 4, kIn), to(8, 20)}, tolerance};
    const auto made = make_tool(shape);
    ASSERT_TRUE(made) << made.error().reason;
    double most = 0;
    for (double h = 2.0005; h < 6; h += 0.001) {
      const double r = test::radius_at(made->pieces, h);
      // Distance of the approximation from the arc's circle, towards the axis.
      const double inside = std::hypot(r - 8, h - 2) - 4;
      EXPECT_GE(inside, -1e-12) << h;
      most = std::max(most, inside);
    }
    EXPECT_LE(most, tolerance * (1 + 1e-9));
    EXPECT_GE(most, tolerance / 8);  // No more sections than needed.
    EXPECT_EQ(test::radius_at(made->pieces, 1), 4);
    EXPECT_EQ(test::radius_at(made->pieces, 7), 8);
  }
}

TEST(ProfileShape, PiecesAreStackedWithoutGaps) {
  const Tool t = *make_tool(ProfileShape{
      {to(1, 0), arc(3, 2, 2), to(3, 5), arc(6, 8, 3, kIn), to(6, 8 + 1e-10), to(2, 20)}});
  double top = 0;
  for (const ToolPiece& p : t.pieces) {
    const auto* f = std::get_if<FrustumPiece>(&p);
    const auto* a = std::get_if<ArcPiece>(&p);
    EXPECT_EQ(f ? f->z0_mm : a->z0_mm, top);
    top = f ? f->z1_mm : a->z1_mm;
  }
  EXPECT_EQ(top, 20);
}

TEST(ProfileShape, PointsRoundedToThreeDecimalsAreAccepted) {
  // An arc of 45 degrees and radius 2: (3 + sqrt 2, 2 - sqrt 2).
  const auto t = make_tool(ProfileShape{{to(3, 0), arc(4.414, 0.586, 2), to(8, 4)}});
  ASSERT_TRUE(t) << t.error().reason;
  const auto c = make_tool(
      ProfileShape{{to(3, 0), ProfileCenteredArc{{4.414, 0.586}, {3, 2}, kOut}, to(8, 4)}});
  ASSERT_TRUE(c) << c.error().reason;
  EXPECT_NEAR(std::get<ArcPiece>(t->pieces[0]).center_r_mm,
              std::get<ArcPiece>(c->pieces[0]).center_r_mm, 2e-3);
}

struct Rejected {
  ProfileShape shape;
  ToolErrorCode code;
  const char* field;
};

TEST(ProfileShape, RejectionNamesTheStepAndTheReason) {
  const double nan = std::nan("");
  using enum ToolErrorCode;
  for (const auto& [shape, code, field] : std::vector<Rejected>{
           {{{}}, kTooShort, "profile_mm"},
           {{{to(5, 0)}}, kTooShort, "profile_mm"},
           {{{arc(5, 0, 1), to(5, 5)}}, kInconsistent, "profile_mm[0]"},
           {{{to(5, 1), to(5, 5)}}, kInconsistent, "profile_mm[0]"},
           {{{to(5, 0), to(5, nan)}}, kNotFinite, "profile_mm[1]"},
           {{{to(5, 0), to(-1, 5)}}, kOutOfRange, "profile_mm[1]"},
           {{{to(5, 0), to(5, 5), to(5, 4)}}, kInconsistent, "profile_mm[2]"},
           {{{to(5, 0), to(3, 0)}}, kNotPositive, "profile_mm"},
           {{{to(0, 0), to(0, 5), to(5, 5), to(5, 9)}}, kInconsistent, "profile_mm[1]"},
           {{{to(5, 0), arc(5, 5, 0)}}, kNotPositive, "profile_mm[1].radius"},
           {{{to(5, 0), arc(5, 5, 2)}}, kInconsistent, "profile_mm[1].radius"},
           {{{to(5, 0), arc(5, 0, 2), to(5, 5)}}, kInconsistent, "profile_mm[1]"},
           {{{to(0, 0), arc(5, 0.5, 5)}}, kInconsistent, "profile_mm[1]"},
           {{{to(5, 0), arc(1, 0.5, 5)}}, kInconsistent, "profile_mm[1]"},
           {{{to(5, 0), ProfileCenteredArc{{5, 4}, {4, 1}, kOut}}},
            kInconsistent,
            "profile_mm[1].center"},
           {{{to(5, 0), ProfileCenteredArc{{5, 4}, {4, 2}, kIn}}},
            kInconsistent,
            "profile_mm[1].center"},
           {{{to(5, 0), ProfileCenteredArc{{5, 4}, {nan, 2}, kIn}}},
            kNotFinite,
            "profile_mm[1].center"},
           {{{to(5, 0), to(5, 5)}, 0}, kOutOfRange, "chord_tolerance_mm"},
           {{{to(5, 0), to(5, 5)}, nan}, kOutOfRange, "chord_tolerance_mm"},
           {{{to(100, 0), arc(4000, 3900, 3900, kIn)}, 1e-6}, kTooManyPieces, "profile_mm[1]"}}) {
    const auto made = make_tool(shape);
    ASSERT_FALSE(made) << field;
    EXPECT_EQ(made.error().field, field) << made.error().reason;
    EXPECT_EQ(made.error().code, code) << field << " " << made.error().reason;
    EXPECT_FALSE(made.error().reason.empty());
  }
}

/// Every outline is rejected with a field, or gives a valid tool: pieces stacked without gaps,
/// within the outline's heights, radius nowhere negative.
TEST(ProfileShape, RandomOutlinesAreValidOrRejected) {
  std::mt19937_64 random(7);
  const auto number = [&] {
    switch (random() % 12) {
      case 0:
        return 0.0;
      case 1:
        return std::numeric_limits<double>::denorm_min();
      case 2:
        return std::numeric_limits<double>::quiet_NaN();
      case 3:
        return std::numeric_limits<double>::infinity();
      case 4:
        return -1.0;
      case 5:
        return 1e-9 * double(random() % 1000);
      default:
        return double(random() % 4000) / 100;
    }
  };
  int sound = 0;
  for (int i = 0; i < 200000; ++i) {
    ProfileShape shape;
    double h = 0;
    const std::size_t n = 2 + random() % 4;
    for (std::size_t k = 0; k < n; ++k) {
      const double r = number();
      const ArcBulge bulge = random() % 2 == 0 ? kOut : kIn;
      switch (k == 0 ? 0 : random() % 3) {
        case 0:
          shape.steps.push_back(to(r, h));
          break;
        case 1:
          shape.steps.push_back(arc(r, h, number(), bulge));
          break;
        default:
          shape.steps.push_back(ProfileCenteredArc{{r, h}, {number() - 5, number()}, bulge});
      }
      h += random() % 8 == 0 ? number() : double(random() % 1000) / 100;
    }
    const auto made = make_tool(shape);
    if (!made) {
      ASSERT_FALSE(made.error().field.empty());
      continue;
    }
    ++sound;
    ASSERT_LE(made->length_mm, cutting_length_mm(shape) + 1e-9);
    for (double share = 0.01; share < 1; share += 0.0371) {
      ASSERT_GE(test::radius_at(made->pieces, share * made->length_mm), -1e-9);
    }
  }
  EXPECT_GT(sound, 1000);
}

}  // namespace
}  // namespace kerf::profile_shape_test
