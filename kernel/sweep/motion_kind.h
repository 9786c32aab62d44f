// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kerf {

/// The four cases of paper section 2.4, and kRest for no motion.
enum class MotionKind { kRest, kAxial, kRotation, kTranslation, kGeneral };

/// How a motion that travels and turns is swept. kPaper: Eq. 12, translate with the start axis,
/// then rotate at the end; first order. kTight: as derived in kernel/sweep/README.md; second order.
enum class MotionModel { kPaper, kTight };

}  // namespace kerf
