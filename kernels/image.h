// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace disparityd {

/// A view of a 2-D array, row-major. It owns nothing; rows lie `stride` elements apart (stride >= width).
/// An empty plane (data == nullptr) means "not wanted" where a function says that a plane is optional.
template <typename T>
struct Plane {
    T* data = nullptr;
    int width = 0;
    int height = 0;
    std::ptrdiff_t stride = 0;

    T* row(int y) const { return data + y * stride; }
    T& at(int x, int y) const { return data[y * stride + x]; }
    explicit operator bool() const { return data != nullptr; }
    operator Plane<const T>() const  // NOLINT(google-explicit-constructor): adding const is always safe
        requires(!std::is_const_v<T>) {
        return {data, width, height, stride};
    }
};

/// A view of the disparity space image (DSI) or of the summed path costs: the `disparities` values of one pixel lie
/// next to each other, pixels of a row follow without gaps, rows too.
template <typename T>
struct Volume {
    T* data = nullptr;
    int width = 0;
    int height = 0;
    int disparities = 0;

    T* pixel(int x, int y) const {
        return data + (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)) *
                          static_cast<std::size_t>(disparities);
    }
    operator Volume<const T>() const  // NOLINT(google-explicit-constructor)
        requires(!std::is_const_v<T>) {
        return {data, width, height, disparities};
    }
};

/// Rows [first, last) of an image: the unit in which work is spread over workers.
struct Rows {
    int first = 0;
    int last = 0;
};

}  // namespace disparityd
