// SPDX-License-Identifier: Apache-2.0
#include "server/downloads/download_routes.h"

#include "server/downloads/download_handlers.h"
#include "server/downloads/replay_handlers.h"
#include "server/http/routes.h"

namespace kerf::net {
namespace {

constexpr Route kRoutes[] = {
    {.pattern = "/v1/sessions/{id}/model.{format}",
     .query = "encoding, triangles, error_mm, shift_mm, at",
     .answer = &download,
     .runs = Runs::kExport,
     .action = Action::kDownload,
     .summary = "the surface as `stl`, `glb`, `3mf`, `ply`, `obj`"},
    {.pattern = "/v1/sessions/{id}/program.ngc",
     .query = "participant, from, to, tolerance_mm, post",
     .answer = &download,
     .runs = Runs::kExport,
     .action = Action::kDownload,
     .summary = "the motions as G-code; `post`: linuxcnc, grbl, fanuc, haas, heidenhain"},
    {.pattern = "/v1/sessions/{id}/program.apt",
     .query = "participant, from, to, tolerance_mm",
     .answer = &download,
     .runs = Runs::kExport,
     .action = Action::kDownload,
     .summary = "the motions as APT"},
    {.pattern = "/v1/sessions/{id}/forces.csv",
     .query = "participant, device_limits",
     .answer = &download,
     .runs = Runs::kExport,
     .action = Action::kDownload,
     .summary = "force and torque of every motion"},
    {.pattern = "/v1/sessions/{id}/forces",
     .query = "participant, from, to, points",
     .answer = &download,
     .runs = Runs::kExport,
     .action = Action::kDownload,
     .summary = "200, least, mean and greatest force and torque of spans of motions, for plots"},
    {.pattern = "/v1/sessions/{id}/thin_walls.json",
     .answer = &download,
     .runs = Runs::kExport,
     .action = Action::kDownload,
     .summary = "walls and grooves below the pitch; whether the target holds"},
    {.pattern = "/v1/sessions/{id}/journal",
     .answer = &download,
     .runs = Runs::kExport,
     .action = Action::kDownload,
     .summary = "the journal, an SQLite database"},
    {.pattern = "/v1/sessions/{id}/replay",
     .query = "at",
     .answer = &replay,
     .runs = Runs::kExport,
     .action = Action::kDownload,
     .summary = "200, for who replays the journal: its name, the last record, the state hash"},
    {.pattern = "/v1/sessions/{id}/hashes",
     .query = "journal, first, last",
     .answer = &journal_hashes,
     .runs = Runs::kExport,
     .action = Action::kDownload,
     .summary = "200, state hashes that a journal has stored while it was written"},
    {.pattern = "/v1/sessions/{id}/origin",
     .query = "journal",
     .answer = &journal_origin,
     .runs = Runs::kExport,
     .action = Action::kDownload,
     .summary = "the scene of a journal and its files; never changes"},
    {.pattern = "/v1/sessions/{id}/records",
     .query = "journal, first, last",
     .answer = &journal_records,
     .runs = Runs::kExport,
     .action = Action::kDownload,
     .summary = "records of a journal, as it stores them; never change"},
    {.pattern = "/v1/sessions/{id}/exports",
     .answer = &list_exports,
     .action = Action::kWatch,
     .at_owner = true,
     .summary = "200, downloads in preparation: name, share, seconds"},
};

}  // namespace

HttpMatter http_downloads() { return {.routes = kRoutes}; }

}  // namespace kerf::net
