// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kerf {

/// The four cases of paper section 2.4, and no motion at all.
enum class MotionKind { kRest, kAxial, kRotation, kTranslation, kGeneral };

/// How a general motion is broken down: kPaper as Eq. 12 (translate with the start axis, then
/// rotate at the end; first order), kTight as kernel/README.md derives it (second order).
enum class MotionModel { kPaper, kTight };

}  // namespace kerf
