// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

namespace disparityd::base {

/// Hands all bytes to the system, in as many calls as it takes. Returns 0, or the number of the error.
int write_all(int descriptor, std::span<const std::byte> bytes);

}  // namespace disparityd::base
