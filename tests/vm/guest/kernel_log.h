// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace vm_guest {

/// All lines of the kernel's log, the oldest first.
std::vector<std::string> kernel_log();

/// Lines of the kernel's log that tell of a fault in the kernel: warnings with a trace, bugs, oopses, stuck tasks.
std::vector<std::string> kernel_complaints();

}  // namespace vm_guest
