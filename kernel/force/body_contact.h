// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "kernel/force/contact_plane.h"

namespace kerf {

/// Contact of the convex parts of a tool with one body: an obstacle, or the stock. Holds the
/// deepest planes, without allocation.
class BodyContact {
 public:
  static constexpr std::size_t kPlanesMax = 16;

  /// Adds the plane of a part, with the stiffness of the body. Replaces the least deep one if there
  /// are already kPlanesMax.
  void add(const ContactPlane& plane);

  /// Returns the planes with the stiffness that each one contributes to the union's contact: parts
  /// that are pushed in one direction share the push of the deepest (kernel/force/README.md). The
  /// planes of gaps keep the body's stiffness. The result is valid until the next call.
  std::span<const ContactPlane> shared();

 private:
  std::array<ContactPlane, kPlanesMax> planes_, shared_;
  std::size_t count_ = 0;
};

}  // namespace kerf
