// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "server/wire/types.h"

namespace kerf::agent {

/// Receives the server's stock updates and results, to maintain a replica of the block. Called on
/// the link thread. Must not block for long.
class StockListener {
 public:
  virtual ~StockListener() = default;
  /// Called for a stock or intent frame. The bytes are valid during the call only.
  virtual void take_stock(std::span<const std::byte> frame) = 0;
  virtual void take_result(const wire::Result& result) = 0;
  /// Returns true once if the server must send the stock from scratch.
  virtual bool wants_reset() = 0;
};

}  // namespace kerf::agent
