#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Tests the USB driver with a real kernel: Debian's kernel in QEMU (TCG, no KVM, no root), its
# dummy_hcd as the bus and the reference firmware's model as a FunctionFS gadget. Exit code 0:
# passed, or skipped with the reason; 1: failed.
#   tests/usb/kernel/run.sh [PRESET]        (release; needs a configured build)
set -euo pipefail
cd "$(dirname "$0")/../../.."

PRESET="${1:-release}"
WORK="$PWD/build/usb_kernel"
MODULES=(configfs usb-common usbcore udc-core libcomposite usb_f_fs dummy_hcd)
LIMIT_S=300

skip() { echo "skipped: $*"; exit 0; }

# Downloads the kernel and busybox, and unpacks them under build/; nothing is installed.
fetch() {
  [ -e "$WORK/root/fetched" ] && return
  rm -rf "$WORK" && mkdir -p "$WORK/root" && chmod a+rwx "$WORK"
  local kernel
  kernel="$(apt-cache depends linux-image-amd64 | awk '/Depends: linux-image/ { print $2; exit }')"
  [ -n "$kernel" ] || return 1
  (cd "$WORK" && apt-get download "$kernel" busybox-static && for deb in ./*.deb; do dpkg -x "$deb" root; done) || return 1
  rm -f "$WORK"/*.deb
  touch "$WORK/root/fetched"
}

# Builds the guest: programs with their libraries, busybox, kernel modules, init.
make_guest() {
  local guest="$WORK/guest" program module library
  rm -rf "$guest" && mkdir -p "$guest"/{bin,lib,lib64,proc,sys,dev,ffs,modules,tmp}
  cp "$WORK/root/bin/busybox" "$guest/bin/busybox"
  for program in usb_kernel_gadget usb_kernel_client; do
    cp "build/$PRESET/tests/usb/$program" "$guest/bin/"
    for library in $(ldd "build/$PRESET/tests/usb/$program" | grep -o '/[^ ]*'); do
      mkdir -p "$guest$(dirname "$library")" && cp -L "$library" "$guest$library"
    done
  done
  for module in "${MODULES[@]}"; do
    cp "$(find "$WORK/root" -name "$module.ko" | head -1)" "$guest/modules/"
  done
  sed "s/@MODULES@/${MODULES[*]}/" tests/usb/kernel/init.sh >"$guest/init" && chmod +x "$guest/init"
  (cd "$guest" && find . | cpio -o -H newc 2>/dev/null | gzip -1) >"$WORK/initramfs.gz"
}

command -v qemu-system-x86_64 >/dev/null || skip "qemu-system-x86_64 is not installed (package qemu-system-x86)"
command -v cpio >/dev/null || skip "cpio is not installed (package cpio)"
mkdir -p build
fetch >build/usb_kernel.log 2>&1 || skip "the kernel's package cannot be downloaded: $(tail -1 build/usb_kernel.log)"
cmake --build --preset "$PRESET" -j2 --target usb_kernel_gadget usb_kernel_client >/dev/null
make_guest
timeout "$LIMIT_S" qemu-system-x86_64 -accel tcg -cpu max -m 512 -smp 2 -nographic -no-reboot \
  -kernel "$(find "$WORK/root/boot" -name 'vmlinuz-*')" -initrd "$WORK/initramfs.gz" \
  -append "console=ttyS0 quiet panic=-1" </dev/null 2>&1 | tr -d '\r' | tee "$WORK/console.log" |
  sed -n 's/.*\(guest: Linux\)/\1/; /^guest: Linux/,$p'
grep -q '^kernel route: passed' "$WORK/console.log"
