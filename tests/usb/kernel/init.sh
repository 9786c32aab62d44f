#!/bin/busybox sh
# SPDX-License-Identifier: Apache-2.0
# init of run.sh's guest: sets up a bus with a gadget, runs the driver and powers off.
/bin/busybox --install -s /bin
export PATH=/bin
mount -t proc none /proc
mount -t sysfs none /sys
mount -t devtmpfs none /dev
for module in @MODULES@; do insmod /modules/$module.ko || echo "guest: no $module"; done
mount -t configfs none /sys/kernel/config
echo "guest: Linux $(uname -r)"

gadget=/sys/kernel/config/usb_gadget/kerf
mkdir -p $gadget/configs/c.1 $gadget/functions/ffs.kerf
echo 0x1209 >$gadget/idVendor
echo 0x0001 >$gadget/idProduct
ln -s $gadget/functions/ffs.kerf $gadget/configs/c.1/
mount -t functionfs kerf /ffs
usb_kernel_gadget /ffs &
sleep 1
echo dummy_udc.0 >$gadget/UDC
usb_kernel_client $gadget/UDC
poweroff -f
