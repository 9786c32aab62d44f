// SPDX-License-Identifier: Apache-2.0
#include "server/session/participant.h"

#include "server/wire/control.h"

namespace kerf {

const char* to_string(ParticipantKind kind) {
  switch (kind) {
    case ParticipantKind::kAgent:
      return wire::kKindAgent.data();
    case ParticipantKind::kProgram:
      return wire::kKindProgram.data();
    case ParticipantKind::kViewer:
      return wire::kKindViewer.data();
  }
  return wire::kKindViewer.data();
}

}  // namespace kerf
