// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "kernels/image.h"

namespace disparityd::cuda {

/// Between planes with a stride and dense memory.
template <typename T>
void gather(Plane<const T> from, T* to) {
    for (int y = 0; y < from.height; ++y) {
        to = std::copy_n(from.row(y), from.width, to);
    }
}

template <typename T>
void scatter(const T* from, Plane<T> to) {
    for (int y = 0; y < to.height; ++y) {
        std::copy_n(from, to.width, to.row(y));
        from += to.width;
    }
}

}  // namespace disparityd::cuda
