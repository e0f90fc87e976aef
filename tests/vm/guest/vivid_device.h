// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace vm_guest {

/// The node of one of the two devices of the kernel's own test driver for V4L2 (module vivid): a camera that is no USB
/// device, takes any size and makes faults on demand. Throws std::runtime_error when it is not loaded.
std::string vivid_node(int device = 0);

/// Sets one of its controls by the name that the driver gives it; a button is pressed whatever the value is. Throws
/// std::runtime_error.
void set_vivid(const std::string& control, int value = 1, int device = 0);

}  // namespace vm_guest
