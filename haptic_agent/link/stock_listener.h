// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "server/wire/types.h"

namespace kerf::agent {

/// Who keeps a copy of the block and follows what the server says of it. Called on the link's
/// thread; must not wait for long.
class StockListener {
 public:
  virtual ~StockListener() = default;
  /// A stock frame has come; the bytes are the listener's to copy.
  virtual void take_stock(std::span<const std::byte> frame) = 0;
  virtual void take_result(const wire::Result& result) = 0;
  /// True once when the server is to begin afresh.
  virtual bool wants_reset() = 0;
};

}  // namespace kerf::agent
