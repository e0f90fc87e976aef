// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

#include "kernels/image.h"

namespace disparityd::test {

/// Memory with guard values before and after, aligned to 64 bytes.
template <typename T>
class GuardedMemory {
public:
    explicit GuardedMemory(std::size_t size) : size_(size), all_(size + 2 * guard + 64 / sizeof(T), value) {
        void* start = all_.data() + guard;
        std::size_t space = (all_.size() - guard) * sizeof(T);
        data_ = static_cast<T*>(std::align(64, sizeof(T), start, space));
    }

    T* data() const { return data_; }
    std::size_t size() const { return size_; }
    bool intact() const {
        const auto is_guard = [](T v) { return v == value; };
        return std::all_of(all_.data(), static_cast<const T*>(data_), is_guard) &&
               std::all_of(static_cast<const T*>(data_) + size_, all_.data() + all_.size(), is_guard);
    }

private:
    static constexpr std::size_t guard = 256;
    static constexpr T value = static_cast<T>(0x5a5a5a5a);

    std::size_t size_;
    std::vector<T> all_;
    T* data_;
};

/// A plane whose rows have guard values between them.
template <typename T>
class GuardedPlane {
public:
    GuardedPlane(int width, int height)
        : width_(width),
          height_(height),
          stride_(width + gap),
          memory_(static_cast<std::size_t>(height) * static_cast<std::size_t>(width + gap)) {
        std::fill_n(memory_.data(), memory_.size(), value);
    }

    Plane<T> plane() const { return {memory_.data(), width_, height_, stride_}; }
    bool intact() const {
        bool gaps = true;
        for (int y = 0; y < height_; ++y) {
            const T* end = plane().row(y) + width_;
            gaps = gaps && std::all_of(end, end + gap, [](T v) { return v == value; });
        }
        return gaps && memory_.intact();
    }

private:
    static constexpr int gap = 37;  // odd, so that rows start at any address
    static constexpr T value = static_cast<T>(0x6b6b6b6b);

    int width_;
    int height_;
    int stride_;
    GuardedMemory<T> memory_;
};

}  // namespace disparityd::test
