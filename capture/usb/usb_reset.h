// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace disparityd::capture {

/// Resets the USB device with this address through libusb, as unplugging it would; drivers bind again by themselves.
/// 0, or a number of errno: EACCES without write access to its node in /dev/bus/usb, ENODEV when it is gone.
int reset_usb_device(int bus, int address);

}  // namespace disparityd::capture
