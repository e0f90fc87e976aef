// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstring>
#include <mutex>
#include <vector>

namespace disparityd::capture {

/// Puts eyes that came one above the other side by side, into buffers of its own that are lent in turn.
/// give_back() by any thread, the rest by one.
class EyeJoiner {
public:
    /// Rows of one eye in bytes, rows per eye, buffers.
    EyeJoiner(std::size_t eye_bytes, int rows, int buffers)
        : eye_bytes_(eye_bytes), rows_(static_cast<std::size_t>(rows)) {
        for (int i = 0; i < buffers; ++i) {
            buffers_.emplace_back(2 * eye_bytes_ * rows_);
            free_.push_back(i);
        }
    }

    bool has_room() {
        const std::lock_guard lock(mutex_);
        return !free_.empty();
    }

    /// A buffer with the frame; there must be room.
    int join(const std::uint8_t* frame, std::ptrdiff_t stride) {
        int index = 0;
        {
            const std::lock_guard lock(mutex_);
            index = free_.back();
            free_.pop_back();
        }
        std::uint8_t* to = buffers_[static_cast<std::size_t>(index)].data();
        const std::ptrdiff_t right = stride * static_cast<std::ptrdiff_t>(rows_);
        for (std::size_t row = 0; row < rows_; ++row, frame += stride, to += 2 * eye_bytes_) {
            std::memcpy(to, frame, eye_bytes_);
            std::memcpy(to + eye_bytes_, frame + right, eye_bytes_);
        }
        return index;
    }

    const std::uint8_t* data(int index) const { return buffers_[static_cast<std::size_t>(index)].data(); }

    void give_back(int index) {
        const std::lock_guard lock(mutex_);
        free_.push_back(index);
    }

private:
    const std::size_t eye_bytes_;
    const std::size_t rows_;
    std::vector<std::vector<std::uint8_t>> buffers_;
    std::mutex mutex_;
    std::vector<int> free_;
};

}  // namespace disparityd::capture
