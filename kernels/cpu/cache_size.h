// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace disparityd::cpu {

/// Bytes of this machine's last-level cache, of one processor's share where there are several; 8 MiB where the system
/// does not tell. Any thread; reads a file of the system, so ask once.
std::size_t last_level_cache_bytes();

}  // namespace disparityd::cpu
