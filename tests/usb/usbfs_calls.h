// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/usb/usbfs_stub.h"

namespace kerf::usb_test {

/// Opens the stub's node and routes this program's system calls for it to the stub.
int open_stub_node(UsbfsStub& stub);

}  // namespace kerf::usb_test
