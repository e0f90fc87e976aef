// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace disparityd::bench {

/// How many cores this process may run on; at least 1.
int allowed_cores();

/// Lines that say where the numbers come from: processor, cores, caches, instruction sets, compiler.
std::vector<std::string> describe_machine();

}  // namespace disparityd::bench
