// SPDX-License-Identifier: Apache-2.0
#include "server/http/history_point.h"

#include <nlohmann/json.hpp>

#include "server/session/session_export.h"
#include "server/store/journal_times.h"
#include "tests/server/undo_fixture.h"
#include "tests/support/test.h"

namespace kerf::net::history_point_test {
namespace {

TEST(HistoryPoint, TimesAreThoseOfRfc3339InUtc) {
  const auto ms = [](const char* text) {
    const auto time = parse_time(text);
    return time ? time->ms : -1;
  };
  EXPECT_EQ(ms("1970-01-01T00:00:00Z"), 0);
  EXPECT_EQ(ms("2000-02-29T12:34:56Z"), 951827696000);
  EXPECT_EQ(ms("2026-11-22T14:03:00Z"), 1795356180000);
  EXPECT_EQ(ms("2026-11-22T14:03:00.25Z"), 1795356180250);
  EXPECT_EQ(ms("2026-11-22T14:03:00.1239Z"), 1795356180123);
  for (const char* text :
       {"", "Z", "2026-11-22", "2026-11-22T14:03:00", "2026-11-22T14:03Z", "2026-11-22 14:03:00Z",
        "2026-11-22T14:03:00.Z", "2026-11-22T14:03:00.xZ", "2026-11-22T14:03:00.12x4Z",
        "2026-11-22T14:03:00+01:00", "2026-13-01T00:00:00Z", "2026-02-29T00:00:00Z",
        "2026-01-01T24:00:00Z", "2026-01-01T00:60:00Z", "2026-01-01T00:00:60Z",
        "1969-12-31T23:59:59Z", "-026-11-22T14:03:00Z", "2026-11-22T14:03:00ZZ"}) {
    EXPECT_EQ(ms(text), -1) << text;
  }
}

TEST(HistoryPoint, IsARecordATimeOrAName) {
  EXPECT_EQ(std::get<std::uint64_t>(parse_point("17").value()), 17U);
  EXPECT_EQ(std::get<WallTime>(parse_point("1970-01-01T00:00:01Z").value()).ms, 1000);
  EXPECT_EQ(std::get<std::string>(parse_point("before lunch").value()), "before lunch");
  EXPECT_EQ(std::get<std::string>(parse_point("-1").value()), "-1");
  EXPECT_FALSE(parse_point(""));
  EXPECT_FALSE(parse_point("a/b"));
}

using JournalTimes = SessionUndo;

TEST_F(JournalTimes, RecordAtATimeIsTheLastOneBefore) {
  create();
  const ParticipantId ada = join("Ada");
  for (int n = 0; n < 5; ++n) {
    stroke(ada, {-15, n - 2.0, -2}, {15, n - 2.0, -2}, 50);
    ASSERT_TRUE(session_->flush());
  }
  std::map<std::int64_t, std::uint64_t> last;  // record of each time
  auto reader = JournalReader::open(session_->journal_file());
  for (auto record = reader->next(); record && *record; record = reader->next()) {
    last[(*record)->wall_ms] = (*record)->sequence;
    EXPECT_EQ(time_of(session_->journal_file(), (*record)->sequence), (*record)->wall_ms);
  }
  ASSERT_GE(last.size(), 2U);
  const auto at = [&](std::int64_t ms) { return record_at(session_->journal_file(), ms); };
  for (std::int64_t ms = last.begin()->first; ms <= last.rbegin()->first; ++ms) {
    ASSERT_EQ(at(ms), std::prev(last.upper_bound(ms))->second) << ms - last.begin()->first;
  }
  EXPECT_EQ(at(0), 0U);
  EXPECT_EQ(at(last.begin()->first - 1), 0U);
  EXPECT_EQ(at(last.rbegin()->first + 1'000'000), session_->sequence());
  EXPECT_EQ(time_of(session_->journal_file(), session_->sequence() + 1), 0);
}

class ForcePlots : public SessionUndo {
 protected:
  nlohmann::json plot(const ForcePlotRequest& request) {
    std::ostringstream out;
    EXPECT_TRUE(export_force_plot(session_->journal_file(), request, out));
    return nlohmann::json::parse(out.str());
  }
  /// Returns force and torque magnitudes, removed volume and time from the lines of forces.csv.
  std::vector<std::array<double, 4>> lines(const ForcesRequest& request) {
    std::stringstream csv;
    EXPECT_TRUE(export_forces(session_->journal_file(), request, csv));
    std::vector<std::array<double, 4>> magnitudes;
    std::string line;
    std::getline(csv, line);
    while (std::getline(csv, line)) {
      std::vector<double> values;
      std::stringstream cells(line);
      for (std::string cell; std::getline(cells, cell, ',');) values.push_back(std::stod(cell));
      magnitudes.push_back({std::hypot(values[7], values[8], values[9]),
                            std::hypot(values[10], values[11], values[12]), values[13], values[0]});
    }
    return magnitudes;
  }
};

TEST_F(ForcePlots, HaveTheExtremesAndMeansOfForcesCsv) {
  create();
  const ParticipantId ada = join("Ada"), bo = join("Bo");
  stroke(ada, {-15, 0, -2}, {15, 0, -2});
  const StrokeId gone = stroke(bo, {0, -15, -3}, {0, 15, -3});
  stroke(ada, {-15, 8, -2}, {15, 8, -2});
  stroke(bo, {-15, -8, -2}, {15, -8, -2});
  undo({gone});
  ASSERT_TRUE(session_->flush());
  const auto all = lines({});
  ASSERT_GT(all.size(), 40U);
  for (const std::size_t points : {1U, 7U, 5000U}) {
    const auto json = plot({.points = points});
    const std::size_t spans = json["first"].size();
    EXPECT_LE(spans, points);
    std::size_t line = 0;
    double greatest = 0, removed_most = 0;
    for (std::size_t n = 0; n < spans; ++n) {
      double removed = 0;
      for (std::size_t m = line; m < line + json["motions"][n].get<std::size_t>(); ++m) {
        removed += all.at(m)[2];
      }
      EXPECT_NEAR(json["removed_mm3"][n], removed, 1e-6 * (1 + removed));
      removed_most = std::max(removed_most, removed);
      const char* names[] = {"force_n", "torque_nmm"};
      for (std::size_t kind = 0; kind < 2; ++kind) {
        double least = INFINITY, most = 0, sum = 0;
        const std::size_t motions = json["motions"][n];
        for (std::size_t m = line; m < line + motions; ++m) {
          least = std::min(least, all.at(m)[kind]);
          most = std::max(most, all.at(m)[kind]);
          sum += all.at(m)[kind];
        }
        const auto& values = json[names[kind]];
        EXPECT_NEAR(values["min"][n], least, 1e-6 * (1 + least));
        EXPECT_NEAR(values["max"][n], most, 1e-6 * (1 + most));
        EXPECT_NEAR(values["mean"][n], sum / static_cast<double>(motions), 1e-6 * (1 + most));
        greatest = std::max(greatest, most);
      }
      line += json["motions"][n].get<std::size_t>();
      EXPECT_EQ(json["time_ms"][n], time_of(session_->journal_file(), json["first"][n]).value());
    }
    EXPECT_EQ(line, all.size());
    EXPECT_GT(greatest, 0.1);
    EXPECT_GT(removed_most, 1);
  }
}

TEST_F(ForcePlots, HaveTheGreatestWrenchOfASpanAndItsPlace) {
  create();
  const ParticipantId ada = join("Ada");
  stroke(ada, {-15, 0, -2}, {15, 0, -2});
  ASSERT_TRUE(session_->flush());
  for (const std::size_t points : {1U, 7U, 5000U}) {
    const auto json = plot({.points = points});
    ASSERT_EQ(json["peak"]["tip_mm"].size(), json["first"].size());
    for (std::size_t n = 0; n < json["first"].size(); ++n) {
      const auto vector = [&](const char* name) {
        const auto& v = json["peak"][name][n];
        return Vec3{v[0], v[1], v[2]};
      };
      const double most_n = json["force_n"]["max"][n];
      EXPECT_NEAR(length(vector("force_n")), most_n, 1e-5 * (1 + most_n));
      // The stroke is along X, so the force is against X and the torque is across it.
      const Vec3 torque = vector("torque_nmm");
      EXPECT_NEAR(dot(vector("force_n"), torque), 0, 1e-2 * most_n * length(torque) + 1e-6);
      if (most_n > 0.1) {
        EXPECT_LT(vector("force_n").x, -0.9 * most_n);
      }
      EXPECT_NEAR(vector("tip_mm").y, 0, 1e-9);
      EXPECT_LE(std::abs(vector("tip_mm").x), 15 + 1e-9);
    }
  }
}

TEST_F(ForcePlots, SelectSpanAndParticipant) {
  create();
  const ParticipantId ada = join("Ada"), bo = join("Bo");
  stroke(ada, {-15, 0, -2}, {15, 0, -2});
  const std::uint64_t from = stroke(bo, {0, -15, -3}, {0, 15, -3});
  const std::uint64_t to = session_->sequence();
  stroke(ada, {-15, 8, -2}, {15, 8, -2});
  ASSERT_TRUE(session_->flush());
  const auto span = plot({.first = from, .last = to, .points = 5000});
  EXPECT_EQ(span["first"].front(), from);
  EXPECT_EQ(span["last"].back(), to);
  EXPECT_EQ(span["motions"].size(), lines({.only = bo}).size());
  EXPECT_EQ(plot({.only = bo, .points = 5000})["force_n"], span["force_n"]);
  const auto of_bo = lines({.only = bo});
  const auto times = plot({.only = bo, .points = 5000})["end_s"];
  ASSERT_EQ(times.size(), of_bo.size());
  for (std::size_t n = 0; n < times.size(); ++n) EXPECT_NEAR(times[n], of_bo[n][3], 1e-5) << n;
  EXPECT_GT(span["end_s"].back(), times.back());  // Ada's first stroke came before
  EXPECT_EQ(plot({.first = to + 1000})["first"].size(), 0U);
}

TEST_F(ForcePlots, CountTheTimeOfUndoneStrokes) {
  create();
  const ParticipantId ada = join("Ada");
  const StrokeId gone = stroke(ada, {-15, 0, -2}, {15, 0, -2});
  stroke(ada, {-15, 8, -2}, {15, 8, -2});
  ASSERT_TRUE(session_->flush());
  const ForcePlotRequest request{.only = ada, .points = 5000};
  const auto before = plot(request)["end_s"];
  undo({gone});
  ASSERT_TRUE(session_->flush());
  const auto after = plot(request)["end_s"];
  ASSERT_LT(after.size(), before.size());
  EXPECT_EQ(after.back(), before.back());
}

TEST_F(ForcePlots, FromTheHistoryEqualThoseFromTheFirstRecord) {
  create();
  const ParticipantId ada = join("Ada"), bo = join("Bo");
  std::vector<StrokeId> strokes;
  for (int n = 0; n < 24; ++n) {
    const double y = -18 + 1.5 * n, x = -16 + 1.4 * n;
    strokes.push_back(stroke(ada, {-15, y, -2 - 0.1 * n}, {15, y, -3}));
    strokes.push_back(stroke(bo, {x, -15, -3}, {x, 15, -2 - 0.05 * n}));
  }
  undo({strokes[3], strokes[40]});
  redo({strokes[3]});
  ASSERT_TRUE(session_->flush());
  const std::uint64_t end = session_->sequence();
  ASSERT_GT(end, 600U);
  SerialWorkers alone;
  int later = 0;
  for (std::uint64_t first = 1; first < end + 50; first += 67) {
    for (const auto& only : {std::optional<ParticipantId>(), std::optional(bo)}) {
      const ForcePlotRequest request{.only = only, .first = first, .last = first + 40};
      const auto start = test::value_of(session_->past().felt_start(first, only, alone));
      EXPECT_LT(start.last, first);
      std::ostringstream all, part;
      ASSERT_TRUE(export_force_plot(session_->journal_file(), request, all));
      ASSERT_TRUE(export_force_plot(session_->journal_file(), request, part, {}, &start));
      EXPECT_EQ(part.str(), all.str()) << first;
      later += start.last > 0 ? 1 : 0;
    }
  }
  EXPECT_GT(later, 10);
}

TEST(PointName, IsPlainUtf8) {
  for (const char* name : {"a", "2nd try", "für Ada", "\xE2\x82\xAC", "\xF0\x9F\x98\x80"}) {
    EXPECT_TRUE(is_point_name(name)) << name;
  }
  for (const char* name : {"", "a/b", "a\nb", "\x7F", "\xFF", "\xC3", "\xC0\xAF", "\xE0\x80\xAF",
                           "\xED\xA0\x80", "\xF4\x90\x80\x80", "\x80", "\xE2\x82"}) {
    EXPECT_FALSE(is_point_name(name)) << name;
  }
  EXPECT_TRUE(is_point_name(std::string(64, 'x')));
  EXPECT_FALSE(is_point_name(std::string(65, 'x')));
}

}  // namespace
}  // namespace kerf::net::history_point_test
