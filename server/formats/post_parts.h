// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <memory>

#include "server/formats/post.h"
#include "server/formats/program_writer.h"

namespace kerf {

// The writers of make_post_writer. `scene` and `out` must outlive them.

/// For LinuxCNC, grbl, Fanuc and Haas.
std::unique_ptr<ProgramWriter> make_gcode_post(Post post, const Scene& scene, std::ostream& out);
/// For HEIDENHAIN controls: Klartext.
std::unique_ptr<ProgramWriter> make_klartext_post(const Scene& scene, std::ostream& out);

}  // namespace kerf
