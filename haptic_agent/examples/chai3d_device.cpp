// SPDX-License-Identifier: Apache-2.0
// chai3d_device SERVER SESSION: carves with the first haptic device that CHAI3D finds.
//   c++ -std=c++14 chai3d_device.cpp -I . -I CHAI3D/src -I CHAI3D/externals/Eigen
//       $(pkg-config --cflags --libs kerf-agent) -lchai3d ...      (as CHAI3D's own examples link)
#include <devices/CHapticDeviceHandler.h>
#include <kerf_chai3d.h>

#include <cstdio>

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: chai3d_device http://HOST:PORT SESSION\n");
    return 2;
  }
  chai3d::cHapticDeviceHandler handler;
  chai3d::cGenericHapticDevicePtr device;
  if (!handler.getDevice(device, 0) || !device->open() || !device->calibrate()) {
    std::fprintf(stderr, "CHAI3D finds no device that opens\n");
    return 1;
  }
  kerf_chai3d::Settings settings;
  settings.server = argv[1];
  settings.session = argv[2];
  kerf_agent_result result = KERF_AGENT_OK;
  {
    kerf_chai3d::Agent agent(device, settings);
    result = agent.join();
    if (result == KERF_AGENT_OK) result = agent.run();
  }
  if (result != KERF_AGENT_OK) std::fprintf(stderr, "%s\n", kerf_agent_last_error());
  device->close();
  return result == KERF_AGENT_OK ? 0 : 1;
}
