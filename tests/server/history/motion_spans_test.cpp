// SPDX-License-Identifier: Apache-2.0
#include "server/history/motion_spans.h"

#include "tests/support/test.h"

namespace kerf::motion_spans_test {
namespace {

Bounds box_at(Vec3 at, double half_mm) {
  const Vec3 half{half_mm, half_mm, half_mm};
  return {at - half, at + half};
}

TEST(MotionSpans, EveryMotionIsInOneSpanOfItsStroke) {
  std::mt19937 random(1);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
  };
  MotionSpans spans(8);
  struct Motion {
    StrokeId stroke;
    Bounds box;
  };
  struct Hand {
    StrokeId stroke = 0;
    Vec3 at;
  };
  std::map<std::uint64_t, Motion> added;
  std::vector<Hand> hands(90);  // more than have open spans
  std::uint64_t record = 0;
  for (int n = 0; n < 20'000; ++n) {
    // At first few hands, then many. Each one begins a stroke occasionally.
    Hand& hand = hands[random() % (n < 10'000 ? 5 : hands.size())];
    record += random() % 40 == 0 ? 1 + random() % 500 : 1;
    if (random() % 50 == 0 || hand.stroke == 0) {
      hand = {record, {uniform(-90, 90), uniform(-90, 90), uniform(-90, 90)}};
    }
    hand.at = hand.at + Vec3{uniform(-1, 1), uniform(-1, 1), 0};
    added[record] = {hand.stroke, box_at(hand.at, 3)};
    spans.add(record, hand.stroke, added[record].box);
  }
  std::set<std::uint64_t> held;
  std::uint64_t before = 0;
  for (const MotionSpan& span : spans.all()) {
    EXPECT_GT(span.run.first, before);
    before = span.run.first;
    for (int n = 0; n < 3; ++n) EXPECT_LE(span.hi_mm[n] - span.lo_mm[n], 14.01F);
    auto motion = added.lower_bound(span.run.first);
    for (; motion != added.end() && motion->first <= span.run.last; ++motion) {
      if (motion->second.stroke != span.run.stroke) continue;
      EXPECT_TRUE(held.insert(motion->first).second);  // no motion is in two spans
      const Bounds all = joined(motion->second.box, span.bounds());
      EXPECT_EQ(all.lo_mm, span.bounds().lo_mm);
      EXPECT_EQ(all.hi_mm, span.bounds().hi_mm);
    }
  }
  EXPECT_EQ(held.size(), added.size());
}

TEST(MotionSpans, AHandAt1kHzTakesTwoBytesAMotion) {
  MotionSpans spans(2 * 32 * 0.25);
  for (std::uint64_t n = 1; n <= 100'000; ++n) {
    // Four hands, 0.2 mm a tick.
    const double x = 0.2 * static_cast<double>(n / 4);
    spans.add(n, 1 + n % 4, box_at({x, 0, 0}, 5));
  }
  const auto bytes = static_cast<double>(spans.all().size_bytes());
  EXPECT_LT(bytes / 100'000, 2);
}

TEST(MotionSpans, AHandThatPausesBeginsANewSpan) {
  MotionSpans spans(8);
  spans.add(1, 1, box_at({}, 1));
  spans.add(1 + MotionSpans::kGap, 1, box_at({}, 1));
  spans.add(2 + 2 * MotionSpans::kGap, 1, box_at({}, 1));
  EXPECT_EQ(spans.all().size(), 2U);  // no records in between need to be read
}

}  // namespace
}  // namespace kerf::motion_spans_test
