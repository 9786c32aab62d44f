// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <optional>
#include <string>

#include "kernel/sculpture.h"
#include "server/convert/tool_track.h"
#include "server/store/record_batch.h"

namespace kerf::page {

/// Turns the samples of a hand into records of a journal, as a session of the server does
/// (server/session/carving.cpp): a stroke begins with the first motion after the tool was lifted.
class HandTrack {
 public:
  /// `participant`: the author of the records, not 0.
  explicit HandTrack(ParticipantId participant) : participant_(participant) {}

  ParticipantId participant() const { return participant_; }
  /// Returns the record of the motion to a sample; nothing if it cuts none. The error, one
  /// sentence, says why the motion is rejected: the tool is then at the sample all the same.
  std::expected<std::optional<BatchRecord>, std::string> take(const wire::MotionSample& sample,
                                                              const Sculpture& block);
  /// The next motion begins a stroke: one has been undone or redone.
  void end_stroke() { in_stroke_ = false; }

 private:
  ParticipantId participant_;
  ToolTrack track_;
  bool in_stroke_ = false;
};

}  // namespace kerf::page
