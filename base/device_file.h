// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace disparityd::base {

/// Opens a device for reading and writing. Returns a descriptor whose calls never wait and which programs that are
/// started do not inherit, or -errno.
int open_device(const std::string& node);

/// Calls ioctl(), again when a signal interrupts it. Returns 0 or errno.
int device_ioctl(int device, unsigned long request, void* argument);

}  // namespace disparityd::base
