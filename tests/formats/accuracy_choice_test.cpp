// SPDX-License-Identifier: Apache-2.0
#include "server/formats/accuracy_choice.h"

#include <nlohmann/json.hpp>

#include "server/formats/scene.h"
#include "tests/support/test.h"

namespace kerf::accuracy_choice_test {
namespace {

using testing::HasSubstr;
using testing::Not;

AccuracyUse use_of(double diameter_mm = 10, bool turns = true) {
  return {.stock = BoxStock{{0, 0, 0}, {100, 100, 50}},
          .tools = {make_tool(BallShape{diameter_mm, 50}).value()},
          .turns = turns};
}

AccuracyChoice choose(const AccuracyRequest& request, const AccuracyUse& use = use_of()) {
  auto choice = choose_accuracy(request, use);
  EXPECT_TRUE(choice.has_value()) << choice.error().reason;
  return choice.value();
}

AccuracyErrorCode rejection(const AccuracyRequest& request, const AccuracyUse& use = use_of()) {
  return test::error_of(choose_accuracy(request, use)).code;
}

AccuracyRequest target(double mm) { return {.target_mm = mm}; }

TEST(AccuracyChoice, ChosenAccuracyMeetsTheTarget) {
  for (const double mm : {0.008, 0.01, 0.03, 0.1, 0.25, 1.0, 3.0}) {
    const AccuracyChoice choice = choose(target(mm));
    EXPECT_LE(choice.predicted_error_mm, mm * (1 + 1e-12));  // rounding
    EXPECT_EQ(choice.predicted_error_mm, predicted_error_mm(choice.accuracy));
    // The choice is not much finer than required.
    EXPECT_GT(choice.predicted_error_mm, 0.95 * mm);
  }
}

TEST(AccuracyChoice, ChosenAccuracyNeverReportsAMissedTarget) {
  // 0.9 pitch + tolerance exceeds the target in the last bit, as at 0.3 mm.
  int exceeding = 0;
  for (int n = 1; n <= 3000; ++n) {
    const double mm = n / 1000.0;
    if (mm < 0.008) continue;
    for (const bool turns : {false, true}) {
      const AccuracyChoice choice = choose(target(mm), use_of(10, turns));
      exceeding += choice.predicted_error_mm > mm ? 1 : 0;
      ASSERT_THAT(choice.reason, Not(HasSubstr("misses"))) << mm;
      // Read back from a scene, all four values are set.
      const Accuracy& a = choice.accuracy;
      const AccuracyChoice again = choose({.target_mm = mm,
                                           .rays = a.rays,
                                           .pitch_mm = a.pitch_mm,
                                           .tolerance_mm = a.tolerance_mm,
                                           .motion = a.motion},
                                          use_of(10, turns));
      ASSERT_THAT(again.reason, Not(HasSubstr("misses"))) << mm;
    }
  }
  EXPECT_GT(exceeding, 0);
  EXPECT_GT(choose(target(0.3)).predicted_error_mm, 0.3);
}

TEST(AccuracyChoice, GivenValuesMayUseTheWholeTarget) {
  const AccuracyRequest whole{.target_mm = 0.3, .pitch_mm = 0.3, .tolerance_mm = 0.03};
  EXPECT_EQ(choose(whole).accuracy, (Accuracy{Rays::kDexel, 0.3, 0.03, MotionModel::kTight}));
  // Without a tolerance, the pitch must leave it a part of the target.
  const auto error = test::error_of(
      choose_accuracy({.target_mm = 0.27, .rays = Rays::kDexel, .pitch_mm = 0.3}, use_of()));
  EXPECT_THAT(error.reason, HasSubstr("leaves nothing of the target of 0.27 mm"));
}

TEST(AccuracyChoice, AMissedTargetIsDistinguishedFromTheExpectedError) {
  const AccuracyRequest all{.target_mm = 0.3,
                            .rays = Rays::kDexel,
                            .pitch_mm = 0.3,
                            .tolerance_mm = 0.03001,
                            .motion = MotionModel::kTight};
  EXPECT_THAT(choose(all).reason, HasSubstr("error 0.30001 mm, which misses the target of 0.3 mm"));
}

TEST(AccuracyChoice, SmallerTargetNeverGetsCoarserPitch) {
  for (const bool turns : {false, true}) {
    Accuracy before{.pitch_mm = 0, .tolerance_mm = 0};
    for (double mm = 0.008; mm < 20; mm *= 1.03) {
      const Accuracy now = choose(target(mm), use_of(10, turns)).accuracy;
      EXPECT_GE(now.pitch_mm, before.pitch_mm) << mm;
      EXPECT_GE(now.tolerance_mm, before.tolerance_mm) << mm;
      before = now;
    }
  }
}

TEST(AccuracyChoice, FixedValuesAreKept) {
  const Accuracy three = choose({.target_mm = 0.1, .rays = Rays::kTriDexel}).accuracy;
  EXPECT_EQ(three.rays, Rays::kTriDexel);
  const Accuracy paper = choose({.target_mm = 0.1, .motion = MotionModel::kPaper}).accuracy;
  EXPECT_EQ(paper.motion, MotionModel::kPaper);
  const AccuracyRequest pitch{.target_mm = 0.1, .pitch_mm = 0.07};
  EXPECT_EQ(choose(pitch).accuracy.pitch_mm, 0.07);
  EXPECT_LE(choose(pitch).predicted_error_mm, 0.1);
  const AccuracyRequest tolerance{.target_mm = 0.1, .tolerance_mm = 0.033};
  EXPECT_EQ(choose(tolerance).accuracy.tolerance_mm, 0.033);
  EXPECT_LE(choose(tolerance).predicted_error_mm, 0.1);
  EXPECT_THAT(choose(tolerance).reason, HasSubstr("0.033 mm (given)"));
}

TEST(AccuracyChoice, FullyFixedRequestIsNeverRejected) {
  const AccuracyRequest all{.target_mm = 0.01,
                            .rays = Rays::kDexel,
                            .pitch_mm = 2.0,
                            .tolerance_mm = 0.5,
                            .motion = MotionModel::kTight};
  const AccuracyChoice choice = choose(all);
  EXPECT_EQ(choice.accuracy, (Accuracy{Rays::kDexel, 2.0, 0.5, MotionModel::kTight}));
  EXPECT_THAT(choice.reason, HasSubstr("misses the target"));
}

TEST(AccuracyChoice, OneFieldAndTightModelAreCheapest) {
  const AccuracyChoice choice = choose(target(0.1));
  EXPECT_EQ(choice.accuracy.rays, Rays::kDexel);
  EXPECT_EQ(choice.accuracy.motion, MotionModel::kTight);
  const AccuracyChoice paper = choose({.target_mm = 0.1, .motion = MotionModel::kPaper});
  const AccuracyChoice three = choose({.target_mm = 0.1, .rays = Rays::kTriDexel});
  EXPECT_LT(choice.predicted_us, paper.predicted_us);
  EXPECT_LT(choice.predicted_us, three.predicted_us);
}

TEST(AccuracyChoice, ThreeFieldsAreChosenIfOneCannotMeetTheTarget) {
  const Accuracy coarse = choose({.target_mm = 0.1, .pitch_mm = 0.12}).accuracy;
  EXPECT_EQ(coarse.rays, Rays::kTriDexel);
  EXPECT_EQ(rejection({.target_mm = 0.1, .rays = Rays::kDexel, .pitch_mm = 0.12}),
            AccuracyErrorCode::kUnreachable);
}

TEST(AccuracyChoice, FinerTargetHasHigherPredictedCost) {
  EXPECT_LT(choose(target(0.2)).predicted_us, choose(target(0.1)).predicted_us);
  EXPECT_LT(choose(target(0.1)).predicted_us, choose(target(0.01)).predicted_us);
}

TEST(AccuracyChoice, WithoutRotaryAxesThePitchGetsMostOfTheTarget) {
  const Accuracy turning = choose(target(0.1), use_of(10, true)).accuracy;
  const Accuracy upright = choose(target(0.1), use_of(10, false)).accuracy;
  EXPECT_LT(upright.tolerance_mm, turning.tolerance_mm);
  EXPECT_GT(upright.pitch_mm, turning.pitch_mm);
}

TEST(AccuracyChoice, PitchIsAtMostTheSmallestToolRadius) {
  EXPECT_LE(choose(target(3), use_of(1)).accuracy.pitch_mm, 0.5);
  EXPECT_THAT(choose(target(3), use_of(1)).reason, HasSubstr("smallest tool"));
  EXPECT_GT(choose(target(3), use_of(10)).accuracy.pitch_mm, 1.5);
}

TEST(AccuracyChoice, ThinWallsLimitThePitch) {
  AccuracyUse use = use_of(10, false);
  use.wall_pitch_mm = 0.14;
  const AccuracyChoice choice = choose(target(0.3), use);
  EXPECT_EQ(choice.accuracy.pitch_mm, 0.14);
  EXPECT_EQ(choice.accuracy.tolerance_mm,
            choose(target(0.3), use_of(10, false)).accuracy.tolerance_mm);
  EXPECT_THAT(choice.reason, HasSubstr("limited by thin walls"));
  EXPECT_EQ(choose(target(0.05), use).accuracy, choose(target(0.05), use_of(10, false)).accuracy);
  EXPECT_EQ(rejection({.target_mm = 0.3, .pitch_mm = 0.2}, use), AccuracyErrorCode::kUnreachable);
  use.wall_pitch_mm = 1e-4;
  EXPECT_EQ(rejection(target(0.3), use), AccuracyErrorCode::kTooMuchMemory);
}

TEST(AccuracyChoice, UnreachableTargetIsRejectedWithItsCode) {
  EXPECT_EQ(rejection({.target_mm = 0.1, .pitch_mm = 0.2}), AccuracyErrorCode::kUnreachable);
  EXPECT_EQ(rejection({.target_mm = 0.1, .tolerance_mm = 0.1}), AccuracyErrorCode::kUnreachable);
  EXPECT_EQ(rejection({.target_mm = 0.1, .pitch_mm = 0.1, .tolerance_mm = 0.05}),
            AccuracyErrorCode::kUnreachable);
  EXPECT_EQ(rejection(target(0.001)), AccuracyErrorCode::kTooMuchMemory);
  EXPECT_EQ(rejection(target(1e-6)), AccuracyErrorCode::kOutOfRange);
  EXPECT_EQ(rejection({.target_mm = 0.003, .rays = Rays::kTriDexel}),
            AccuracyErrorCode::kTooMuchMemory);
}

TEST(AccuracyChoice, TargetNamedByMemoryErrorIsAccepted) {
  AccuracyUse use = use_of();
  use.stock = BoxStock{{0, 0, 0}, {10000, 10000, 100}};
  const auto error = test::error_of(choose_accuracy(target(0.05), use));
  const std::string words = "allows a target of ";
  const auto at = error.reason.find(words);
  ASSERT_NE(at, std::string::npos) << error.reason;
  const double allowed = std::stod(error.reason.substr(at + words.size()));
  EXPECT_TRUE(choose_accuracy(target(1.1 * allowed), use).has_value()) << allowed;
}

TEST(AccuracyChoice, EqualRequestsGiveEqualChoices) {
  // Literal values, because every machine must make the same choice.
  EXPECT_EQ(choose(target(0.05)).accuracy,
            (Accuracy{Rays::kDexel, 0.05, 0.005, MotionModel::kTight}));
  EXPECT_EQ(choose(target(0.3), use_of(10, false)).accuracy,
            (Accuracy{Rays::kDexel, 0.326, 0.006, MotionModel::kTight}));
}

std::string scene_text(const std::string& accuracy) {
  return R"({"stock": {"shape": "box", "min_mm": [0,0,0], "max_mm": [100,100,50]}, "accuracy": )" +
         accuracy +
         R"(, "tools": [{"id": 1, "shape": "ball", "diameter_mm": 10, "length_mm": 50}],
             "machine": {"kinematics": "tool-vector"}})";
}

TEST(SceneTarget, IsResolvedByParseScene) {
  const auto scene = test::value_of(parse_scene(scene_text(R"({"target_mm": 0.05})"), {}));
  ASSERT_TRUE(scene.accuracy.has_value());
  EXPECT_EQ(accuracy_of(scene), choose(target(0.05)).accuracy);
  EXPECT_FALSE(parse_scene(scene_text(R"({"pitch_mm": 1})"), {})->accuracy.has_value());
}

TEST(SceneTarget, CanonicalTextKeepsTargetAndChoice) {
  const auto scene =
      parse_scene(scene_text(R"({"target_mm": 0.05, "tolerance_mm": 0.002})"), {}).value();
  const std::string text = scene_json(scene);
  const auto again = test::value_of(parse_scene(text, {}));
  EXPECT_EQ(scene_json(again), text);
  EXPECT_EQ(accuracy_of(again), accuracy_of(scene));
  EXPECT_EQ(again.accuracy->request.target_mm, 0.05);
}

TEST(SceneTarget, StoredValuesAreNotChosenAgain) {
  // Values that the current models would not choose.
  const auto scene = test::value_of(parse_scene(
      scene_text(
          R"({"target_mm": 0.05, "rays": "dexel", "pitch_mm": 3, "tolerance_mm": 1, "motion": "paper"})"),
      {}));
  EXPECT_EQ(accuracy_of(scene), (Accuracy{Rays::kDexel, 3, 1, MotionModel::kPaper}));
}

TEST(SceneTarget, InvalidTargetsAreRejectedWithTheirPath) {
  for (const auto& [accuracy, path, reason] : std::vector<std::array<const char*, 3>>{
           {R"({"target_mm": 0})", "accuracy.target_mm", "above 0"},
           {R"({"target_mm": -1})", "accuracy.target_mm", "above 0"},
           {R"({"target_mm": "fine"})", "accuracy.target_mm", "number"},
           {R"({"target_mm": 0.1, "pitch_mm": 1})", "accuracy.pitch_mm", "target"},
           {R"({"target_mm": 0.1, "tolerance_mm": 1})", "accuracy.tolerance_mm", "target"},
           {R"({"target_mm": 0.001})", "accuracy.target_mm", "GiB"},
           {R"({"target_mm": 1e-300})", "accuracy.target_mm", ""}}) {
    const auto scene = parse_scene(scene_text(accuracy), {});
    ASSERT_FALSE(scene.has_value()) << accuracy;
    EXPECT_EQ(scene.error().path, path) << accuracy;
    EXPECT_THAT(scene.error().reason, HasSubstr(reason));
  }
}

TEST(SceneTarget, IsShownByExplain) {
  const auto scene = parse_scene(scene_text(R"({"target_mm": 0.05})"), {}).value();
  EXPECT_THAT(explain_scene(scene), HasSubstr("accuracy for a target of 0.05 mm: dexel, pitch"));
  const auto plain = parse_scene(scene_text("{}"), {}).value();
  EXPECT_THAT(explain_scene(plain), HasSubstr("accuracy.target_mm"));
  const auto json = nlohmann::json::parse(accuracy_json(scene));
  EXPECT_EQ(json["target_mm"], 0.05);
  EXPECT_EQ(json["pitch_mm"], scene.settings.pitch_mm);
  EXPECT_THAT(std::string(json["reason"]), HasSubstr("expected surface error"));
}

}  // namespace
}  // namespace kerf::accuracy_choice_test
