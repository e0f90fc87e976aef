// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>

#include "kernels/image.h"

namespace disparityd::pipeline {

/// Owns zeroed memory that is aligned to a cache line. The constructor throws std::runtime_error when there is not
/// enough.
class AlignedBuffer {
public:
    AlignedBuffer() = default;
    explicit AlignedBuffer(std::size_t bytes);

    std::byte* data() const { return bytes_.get(); }
    std::size_t size() const { return size_; }

    /// Returns a dense plane that starts at the buffer, which must be large enough.
    template <typename T>
    Plane<T> plane(int width, int height) const {
        return {reinterpret_cast<T*>(bytes_.get()), width, height, width};
    }

private:
    struct Free {
        void operator()(std::byte* bytes) const { std::free(bytes); }
    };
    std::unique_ptr<std::byte, Free> bytes_;
    std::size_t size_ = 0;
};

}  // namespace disparityd::pipeline
