// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "haptic_agent/record/byte_writer.h"
#include "haptic_agent/record/mcap_writer.h"
#include "haptic_agent/servo/tick_tape.h"

namespace kerf::agent {

/// Topic, encoding and schema of a recording's messages: kerf_msgs/msg/HapticTick in ROS 2's
/// message language, in CDR. The schema states every unit.
const mcap::ChannelType& tick_channel();

/// Appends the CDR of a tick: 252 bytes.
void append_tick(mcap::Bytes& out, const TickRecord& tick);

/// Returns the tick of a message, or nullopt if the message is too short, or if this version does
/// not know its phase, trip or mode.
std::optional<TickRecord> tick_of(std::span<const std::byte> message);

}  // namespace kerf::agent
