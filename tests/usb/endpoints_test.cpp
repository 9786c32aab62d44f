// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/usb/endpoints.h"

#include "haptic_agent/device/usb/usb_fault.h"
#include "tests/support/test.h"

namespace kerf::agent::endpoints_test {
namespace {

const InterfaceShape kBulkPair{
    .number = 1, .usb_class = 0xFF, .endpoints = {{0x02, 2, 64}, {0x83, 2, 64}}};

TEST(Endpoints, FoundByTypeAndDirection) {
  const InterfaceShape hid{.usb_class = 3, .endpoints = {{0x81, 3, 8}}};
  const InterfaceShape all[] = {hid, kBulkPair};
  const auto pipes =
      test::value_of(find_pipes(all, {.kind = TransferKind::kBulk, .min_packet_bytes = 64}));
  EXPECT_EQ(pipes.interface_number, 1);
  EXPECT_EQ(pipes.in, 0x83);
  EXPECT_EQ(pipes.out, 0x02);
}

TEST(Endpoints, FirstMatchingSettingIsUsed) {
  const InterfaceShape none{.number = 0, .alternate = 0, .usb_class = 0xFF};
  const InterfaceShape full{
      .number = 0, .alternate = 1, .usb_class = 0xFF, .endpoints = {{0x81, 3, 64}, {0x01, 3, 64}}};
  const InterfaceShape all[] = {none, full};
  EXPECT_EQ(test::value_of(find_pipes(all, {.usb_class = 0xFF})).alternate, 1);
}

TEST(Endpoints, MismatchesAreRejected) {
  const InterfaceShape all[] = {kBulkPair};
  EXPECT_FALSE(find_pipes(all, {.kind = TransferKind::kInterrupt}));
  EXPECT_FALSE(find_pipes(all, {.usb_class = 3, .kind = TransferKind::kBulk}));
  EXPECT_FALSE(find_pipes(all, {.kind = TransferKind::kBulk, .min_packet_bytes = 65}));
  EXPECT_FALSE(find_pipes({}, {.kind = TransferKind::kBulk}));
  const InterfaceShape in_only[] = {{.endpoints = {{0x81, 3, 64}}}};
  EXPECT_FALSE(find_pipes(in_only, {}));
  EXPECT_TRUE(find_pipes(in_only, {.needs_out = false}));
}

TEST(UsbFaults, TextsContainTheRemedy) {
  const auto text = [](UsbFault fault) { return usb_error(fault, "Novint Falcon").text; };
  EXPECT_NE(text(UsbFault::kPermission).find("70-kerf.rules"), std::string::npos);
  EXPECT_NE(text(UsbFault::kPermission).find("udevadm"), std::string::npos);
  EXPECT_NE(text(UsbFault::kBusy).find("another program"), std::string::npos);
  EXPECT_NE(text(UsbFault::kNotFound).find("not plugged in"), std::string::npos);
  for (int fault = 0; fault <= static_cast<int>(UsbFault::kIo); ++fault) {
    EXPECT_TRUE(text(static_cast<UsbFault>(fault)).starts_with("the Novint Falcon ")) << fault;
  }
}

}  // namespace
}  // namespace kerf::agent::endpoints_test
