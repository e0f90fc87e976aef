// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>

#include "kernels/image.h"
#include "kernels/parallel.h"

namespace disparityd::cuda {

/// Calls copy(first row, row after the last) for parts of a plane side by side. One core copies at a fraction of what a
/// GPU's bus carries, but a part has to be worth waking a worker.
template <typename Copy>
void copy_in_parts(int height, std::size_t row_bytes, Parallel& workers, Copy copy) {
    constexpr std::size_t bytes_of_part = 128 * 1024;
    const std::size_t worth = static_cast<std::size_t>(height) * row_bytes / bytes_of_part;
    const int parts = static_cast<int>(std::clamp<std::size_t>(worth, 1, static_cast<std::size_t>(workers.workers())));
    workers.for_each(parts, [&](int part) { copy(height * part / parts, height * (part + 1) / parts); });
}

/// Between planes with a stride and dense memory.
template <typename T>
void gather(Plane<const T> from, T* to, Parallel& workers) {
    copy_in_parts(from.height, static_cast<std::size_t>(from.width) * sizeof(T), workers, [&](int first, int end) {
        for (int y = first; y < end; ++y) {
            std::copy_n(from.row(y), from.width, to + static_cast<std::ptrdiff_t>(y) * from.width);
        }
    });
}

template <typename T>
void scatter(const T* from, Plane<T> to, Parallel& workers) {
    copy_in_parts(to.height, static_cast<std::size_t>(to.width) * sizeof(T), workers, [&](int first, int end) {
        for (int y = first; y < end; ++y) {
            std::copy_n(from + static_cast<std::ptrdiff_t>(y) * to.width, to.width, to.row(y));
        }
    });
}

}  // namespace disparityd::cuda
