// SPDX-License-Identifier: Apache-2.0
#include "tests/usb/model/usb_model.h"

#include <initializer_list>

namespace kerf::usb_test {
namespace {

std::uint8_t low(std::uint16_t v) { return static_cast<std::uint8_t>(v & 0xFFU); }
std::uint8_t high(std::uint16_t v) { return static_cast<std::uint8_t>(v >> 8); }

void append(Bytes& bytes, std::initializer_list<std::uint8_t> more) {
  for (const std::uint8_t byte : more) bytes.push_back(byte);
}

void append_endpoint(Bytes& bytes, std::uint8_t address, const UsbShape& shape) {
  append(bytes, {7, 5, address, shape.kind, low(shape.packet_bytes), high(shape.packet_bytes), 1});
}

}  // namespace

Bytes descriptors_of(const UsbShape& shape) {
  Bytes bytes;
  append(bytes, {18, 1, 0x00, 0x02, 0, 0, 0, 64, low(shape.vendor), high(shape.vendor),
                 low(shape.product), high(shape.product), 0, 1, 0, 0, 0, 1});
  const std::uint8_t endpoints = shape.out_address != 0 ? 2 : 1;
  const auto total = static_cast<std::uint16_t>(9 + 9 + 7 * endpoints);
  append(bytes, {9, 2, low(total), high(total), 1, 1, 0, 0x80, 50});
  append(bytes,
         {9, 4, 0, 0, endpoints, shape.usb_class, shape.usb_subclass, shape.usb_protocol, 0});
  append_endpoint(bytes, shape.in_address, shape);
  if (shape.out_address != 0) append_endpoint(bytes, shape.out_address, shape);
  return bytes;
}

}  // namespace kerf::usb_test
