// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace disparityd {

/// Memory for a volume: zeroed, aligned to a page, in large pages where the system has them (a volume is read along
/// lines of every direction, which costs a translation per pixel with small ones).
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

private:
    std::byte* data_ = nullptr;
    std::size_t size_ = 0;
};

}  // namespace disparityd
