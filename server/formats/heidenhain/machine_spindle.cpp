// SPDX-License-Identifier: Apache-2.0
// Spindle, coolant and stops of KlartextMachine, which move nothing.
#include "server/formats/heidenhain/machine.h"

namespace kerf {

// Remarks of M0 to M14 to the machine.
void KlartextMachine::remark(int code) {
  using Kind = MachineRemark::Kind;
  if (code <= 1) path_.remark({.kind = code == 0 ? Kind::kStop : Kind::kOptionalStop});
  if (code == 3 || code == 13) turn_spindle(Kind::kSpindleClockwise);
  if (code == 4 || code == 14) turn_spindle(Kind::kSpindleCounterClockwise);
  if (code == 5) path_.remark({.kind = Kind::kSpindleStop});
  if (code == 5) turning_.reset();
  if (code == 7) path_.remark({.kind = Kind::kMist});
  if (code == 8 || code == 13 || code == 14) path_.remark({.kind = Kind::kFlood});
  if (code == 9) path_.remark({.kind = Kind::kCoolantOff});
}

void KlartextMachine::turn_spindle(MachineRemark::Kind direction) {
  turning_ = direction;
  path_.remark({.kind = direction, .rpm = rpm_});
}

}  // namespace kerf
