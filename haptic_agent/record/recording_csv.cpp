// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <charconv>
#include <ostream>
#include <string>

#include "haptic_agent/device/units.h"
#include "haptic_agent/record/recording.h"
#include "server/wire/types.h"

namespace kerf::agent {
namespace {

constexpr const char* kHeader =
    "t_s,x,y,z,i,j,k,cutting,tool,"
    "computed_fx_n,computed_fy_n,computed_fz_n,computed_tx_nmm,computed_ty_nmm,computed_tz_nmm,"
    "requested_fx_n,requested_fy_n,requested_fz_n,requested_tx_nmm,requested_ty_nmm,"
    "requested_tz_nmm,felt_fx_n,felt_fy_n,felt_fz_n,felt_tx_nmm,felt_ty_nmm,felt_tz_nmm,"
    "energy_mj,felt_share,answer_age_us,pose_us,time_us,buttons,lost_ticks,phase,trip,mode,"
    "has_pose\n";

/// A line of a table. Numbers have the fewest digits that round-trip.
class Line {
 public:
  template <typename T>
  Line& add(T value) {
    std::array<char, 32> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
    return text({digits.data(), static_cast<std::size_t>(end - digits.data())});
  }
  Line& add(Vec3 v) { return add(v.x).add(v.y).add(v.z); }
  Line& add(const Wrench& wrench) { return add(wrench.force_n).add(wrench.torque_nmm); }
  Line& text(std::string_view field) {
    if (!line_.empty()) line_ += ',';
    line_ += field;
    return *this;
  }
  const std::string& line() const { return line_; }

 private:
  std::string line_;
};

}  // namespace

void write_csv(std::ostream& out, const Recording& recording) {
  out << kHeader;
  if (recording.ticks.empty()) return;
  const std::uint64_t start_us = recording.ticks.front().time_us;
  for (const TickRecord& t : recording.ticks) {
    Line line;
    line.add(static_cast<double>(t.time_us - start_us) * kSPerUs).add(t.tip_mm).add(t.axis);
    line.add((t.buttons & wire::kButtonCutting) != 0 ? 1 : 0).add(t.tool_id);
    line.add(t.computed).add(t.requested).add(t.felt);
    line.add(t.energy_mj).add(t.felt_share).add(t.answer_age_us).add(t.pose_us).add(t.time_us);
    line.add(t.buttons).add(t.lost).text(to_string(t.phase)).text(to_string(t.trip));
    line.text(to_string(t.mode)).add(t.has_pose ? 1 : 0);
    out << line.line() << '\n';
  }
}

}  // namespace kerf::agent
