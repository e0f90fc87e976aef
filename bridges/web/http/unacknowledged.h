// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace disparityd::web {

/// Returns how many bytes of a connection wait in this system, or are on their way and not acknowledged by the peer's
/// system; 0 where the system does not tell.
std::size_t unacknowledged_bytes(int descriptor);

}  // namespace disparityd::web
