// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace disparityd {

/// So many bytes, rounded up to whole cache lines: what comes after them is aligned as vectors are.
constexpr std::size_t round_up_to_cache_line(std::size_t bytes) {
    constexpr std::size_t line = 64;
    return (bytes + line - 1) / line * line;
}

}  // namespace disparityd
