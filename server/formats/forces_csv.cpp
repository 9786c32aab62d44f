// SPDX-License-Identifier: Apache-2.0
#include "server/formats/forces_csv.h"

#include <array>
#include <ostream>

#include "server/formats/number_text.h"

namespace kerf {
namespace {

constexpr int kValueDigits = 9;
constexpr int kTimeDigits = 12;

}  // namespace

void write_forces_header(std::ostream& out, const std::optional<WrenchMaximum>& device) {
  out << "t_s,x,y,z,i,j,k,fx_n,fy_n,fz_n,tx_nmm,ty_nmm,tz_nmm,removed_mm3,"
         "imprint_mm3";
  if (device) out << ",felt_fx_n,felt_fy_n,felt_fz_n,felt_tx_nmm,felt_ty_nmm,felt_tz_nmm";
  out << '\n';
}

void write_forces_row(std::ostream& out, double time_s, const ToolPose& pose,
                      const MotionResult& result, const std::optional<WrenchMaximum>& device) {
  const Wrench& wrench = result.wrench;
  out << significant_text(time_s, kTimeDigits);
  for (const double value :
       {pose.tip_mm.x, pose.tip_mm.y, pose.tip_mm.z, pose.axis.x, pose.axis.y, pose.axis.z})
    out << ',' << exact_text(value);
  for (const double value :
       {wrench.force_n.x, wrench.force_n.y, wrench.force_n.z, wrench.torque_nmm.x,
        wrench.torque_nmm.y, wrench.torque_nmm.z, result.removed_mm3, result.imprint_mm3})
    out << ',' << significant_text(value, kValueDigits);
  if (device) {
    const Wrench felt = wrench * share_within(*device, wrench);
    for (const double value : {felt.force_n.x, felt.force_n.y, felt.force_n.z, felt.torque_nmm.x,
                               felt.torque_nmm.y, felt.torque_nmm.z})
      out << ',' << significant_text(value, kValueDigits);
  }
  out << '\n';
}

}  // namespace kerf
