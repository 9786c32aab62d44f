// SPDX-License-Identifier: Apache-2.0
// A plugin for plugin_test.cpp. Built several times: KERF_FAKE_ABI, KERF_FAKE_SYMBOL and
// KERF_FAKE_READ replace one of its properties each.
#include "tests/agent/device/fake_plugin.h"

#include <cstdint>
#include <cstdio>
#include <string>

#ifndef KERF_FAKE_ABI
#define KERF_FAKE_ABI KERF_AGENT_ABI
#endif
#ifndef KERF_FAKE_SYMBOL
#define KERF_FAKE_SYMBOL kerf_agent_plugin
#endif
#ifndef KERF_FAKE_READ
#define KERF_FAKE_READ read_pose
#endif

namespace {

using kerf::agent::FakePluginLog;

FakePluginLog& log_of(void* device) { return *static_cast<FakePluginLog*>(device); }

kerf_agent_result open_device(const kerf_agent_place* place, void** device, char* error,
                              size_t error_bytes) {
  const std::string argument = place->argument;
  if (argument.empty()) {
    std::snprintf(error, error_bytes, "no argument");
    return KERF_AGENT_DEVICE;
  }
  auto* log = reinterpret_cast<FakePluginLog*>(std::stoull(argument));
  log->place = *place;
  *device = log;
  return KERF_AGENT_OK;
}

kerf_agent_result rate(void* device, kerf_agent_capabilities* capabilities) {
  const char* const name = capabilities->name;
  *capabilities = log_of(device).capabilities;
  capabilities->name = name;
  return log_of(device).rated;
}

[[maybe_unused]] void read_pose(void* device, uint64_t now_us, kerf_agent_pose* pose) {
  log_of(device).asked_us = now_us;
  *pose = log_of(device).pose;
}

void write_wrench(void* device, const kerf_agent_wrench* wrench) {
  log_of(device).wrench = *wrench;
}
void stop(void* device) { ++log_of(device).stops; }
void close_device(void* device) { ++log_of(device).closes; }

}  // namespace

extern "C" KERF_AGENT_API const kerf_agent_device* KERF_FAKE_SYMBOL(void) {
  static const kerf_agent_device kTable = {.struct_size = sizeof kTable,
                                           .abi = KERF_FAKE_ABI,
                                           .name = "fake plugin",
                                           .open = open_device,
                                           .capabilities = rate,
                                           .read_pose = KERF_FAKE_READ,
                                           .write_wrench = write_wrench,
                                           .stop = stop,
                                           .close = close_device};
  return &kTable;
}
