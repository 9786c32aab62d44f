// SPDX-License-Identifier: Apache-2.0
#include "server/matters.h"

#include "server/pins/pin_routes.h"
#include "server/pins/pins.h"
#include "server/versions/version_routes.h"
#include "server/versions/versions.h"

namespace kerf::net {
namespace {

struct Registered {
  MakeMatter make;
  std::span<const Route> (*routes)();
};

constexpr Registered kMatters[] = {
    {&Versions::make, &version_routes},
    {&Pins::make, &pin_routes},
};

}  // namespace

std::vector<MakeMatter> matters() {
  std::vector<MakeMatter> all;
  for (const Registered& matter : kMatters) all.push_back(matter.make);
  return all;
}

std::vector<std::span<const Route>> matter_routes() {
  std::vector<std::span<const Route>> all;
  for (const Registered& matter : kMatters) all.push_back(matter.routes());
  return all;
}

}  // namespace kerf::net
