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
     .action = Action::kDownload},
    {.pattern = "/v1/sessions/{id}/program.ngc",
     .query = "participant, from, to, tolerance_mm, post",
     .answer = &download,
     .runs = Runs::kExport,
     .action = Action::kDownload},
    {.pattern = "/v1/sessions/{id}/program.apt",
     .query = "participant, from, to, tolerance_mm",
     .answer = &download,
     .runs = Runs::kExport,
     .action = Action::kDownload},
    {.pattern = "/v1/sessions/{id}/forces.csv",
     .query = "participant, device_limits",
     .answer = &download,
     .runs = Runs::kExport,
     .action = Action::kDownload},
    {.pattern = "/v1/sessions/{id}/forces",
     .query = "participant, from, to, points",
     .answer = &download,
     .runs = Runs::kExport,
     .action = Action::kDownload},
    {.pattern = "/v1/sessions/{id}/thin_walls.json",
     .answer = &download,
     .runs = Runs::kExport,
     .action = Action::kDownload},
    {.pattern = "/v1/sessions/{id}/journal",
     .answer = &download,
     .runs = Runs::kExport,
     .action = Action::kDownload},
    {.pattern = "/v1/sessions/{id}/replay",
     .query = "at",
     .answer = &replay,
     .runs = Runs::kExport,
     .action = Action::kDownload},
    {.pattern = "/v1/sessions/{id}/hashes",
     .query = "journal, first, last",
     .answer = &journal_hashes,
     .runs = Runs::kExport,
     .action = Action::kDownload},
    {.pattern = "/v1/sessions/{id}/origin",
     .query = "journal",
     .answer = &journal_origin,
     .runs = Runs::kExport,
     .action = Action::kDownload},
    {.pattern = "/v1/sessions/{id}/records",
     .query = "journal, first, last",
     .answer = &journal_records,
     .runs = Runs::kExport,
     .action = Action::kDownload},
    {.pattern = "/v1/sessions/{id}/exports",
     .answer = &list_exports,
     .action = Action::kWatch,
     .at_owner = true},
};

}  // namespace

HttpMatter http_downloads() { return {.routes = kRoutes}; }

}  // namespace kerf::net
