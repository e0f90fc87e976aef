// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace disparityd::base {

/// Raises the soft limit of open file descriptors of this process to the hard one. Returns the limit that holds now;
/// SIZE_MAX where there is none, or the system does not tell.
std::size_t raise_descriptor_limit();

}  // namespace disparityd::base
