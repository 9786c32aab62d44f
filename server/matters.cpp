// SPDX-License-Identifier: Apache-2.0
#include "server/matters.h"

#include "server/downloads/download_routes.h"
#include "server/merge/merge_routes.h"
#include "server/people/people_routes.h"
#include "server/pictures/picture_routes.h"
#include "server/pins/pin_routes.h"
#include "server/pins/pins.h"
#include "server/probe/probe_routes.h"
#include "server/programs/program_routes.h"
#include "server/strokes/stroke_routes.h"
#include "server/targets/target_routes.h"
#include "server/tools/tool_routes.h"
#include "server/versions/version_routes.h"
#include "server/versions/versions.h"

namespace kerf::net {
namespace {

struct Registered {
  MakeMatter make;  ///< null: no list in the journal
  HttpMatter (*http)();
};

constexpr Registered kMatters[] = {
    {&Versions::make, &http_versions},
    {&Pins::make, &http_pins},
    {nullptr, &http_targets},
    {nullptr, &http_programs},
    {nullptr, &http_strokes},
    {nullptr, &http_people},
    {nullptr, &http_downloads},
    {nullptr, &http_pictures},
    {nullptr, &http_probe},
    {nullptr, &http_tools},
    {nullptr, &http_merge},
};

}  // namespace

std::vector<MakeMatter> matters() {
  std::vector<MakeMatter> all;
  for (const Registered& matter : kMatters) {
    if (matter.make != nullptr) all.push_back(matter.make);
  }
  return all;
}

std::vector<HttpMatter> http_matters() {
  std::vector<HttpMatter> all;
  for (const Registered& matter : kMatters) all.push_back(matter.http());
  return all;
}

}  // namespace kerf::net
