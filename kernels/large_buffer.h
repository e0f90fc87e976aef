// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "kernels/image.h"

namespace disparityd {

/// Memory for a volume or the planes of a frame: zeroed, aligned to a page. From 2 MB on it begins and ends at a
/// multiple of 2 MB and asks for pages of that size, the large ones of x86 and of arm64 with 4 kB pages: a volume is
/// read along lines of every direction, which costs a translation per pixel with small ones. Whether it gets them is up
/// to the system's setting (/sys/kernel/mm/transparent_hugepage/enabled); without them all works the same.
class LargeBuffer {
public:
    LargeBuffer() = default;
    /// Throws std::runtime_error that says how many MB were wanted when the system refuses.
    explicit LargeBuffer(std::size_t size);
    ~LargeBuffer();
    LargeBuffer(LargeBuffer&& other) noexcept;
    LargeBuffer& operator=(LargeBuffer&& other) noexcept;

    std::byte* data() const { return data_; }
    std::size_t size() const { return size_; }

    /// Returns a dense plane that begins with the buffer, which must be large enough.
    template <typename T>
    Plane<T> plane(int width, int height) const {
        return {reinterpret_cast<T*>(data_), width, height, width};
    }

private:
    std::byte* data_ = nullptr;
    std::size_t size_ = 0;
    std::size_t mapped_ = 0;
};

/// Returns how many bytes all LargeBuffers of this process have. The system gives them when they are first written, so
/// a program compares what a matcher took with what the machine has before it matches.
std::size_t large_memory_held();

/// Has the system give all of that memory now, so that no frame waits for it and none is missing later; what it holds
/// stays. Any thread, while others use the buffers. Throws std::runtime_error when the system has not got it.
void fault_in_large_memory();

}  // namespace disparityd
