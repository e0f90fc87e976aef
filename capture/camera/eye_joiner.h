// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstring>
#include <mutex>
#include <vector>

#include "capture/loan_pool.h"

namespace disparityd::capture {

/// Puts eyes that came one above the other side by side, into buffers of its own that are lent in turn.
/// give_back() by any thread, the rest by one.
class EyeJoiner {
public:
    /// `eye_bytes` are those of one row of one eye, `rows` those of one eye.
    EyeJoiner(std::size_t eye_bytes, int rows, int buffers)
        : eye_bytes_(eye_bytes),
          rows_(static_cast<std::size_t>(rows)),
          buffers_(static_cast<std::size_t>(buffers), std::vector<std::uint8_t>(2 * eye_bytes_ * rows_)),
          free_(buffers_.size()) {}

    bool has_room() {
        const std::lock_guard lock(mutex_);
        return free_.has_free();
    }

    /// Copies the frame into a buffer and returns its number. There must be room.
    int join(const std::uint8_t* frame, std::ptrdiff_t stride) {
        std::size_t index = 0;
        {
            const std::lock_guard lock(mutex_);
            index = free_.take();
        }
        std::uint8_t* to = buffers_[index].data();
        const std::ptrdiff_t right = stride * static_cast<std::ptrdiff_t>(rows_);
        for (std::size_t row = 0; row < rows_; ++row, frame += stride, to += 2 * eye_bytes_) {
            std::memcpy(to, frame, eye_bytes_);
            std::memcpy(to + eye_bytes_, frame + right, eye_bytes_);
        }
        return static_cast<int>(index);
    }

    const std::uint8_t* data(int index) const { return buffers_[static_cast<std::size_t>(index)].data(); }

    void give_back(int index) {
        const std::lock_guard lock(mutex_);
        free_.give_back(static_cast<std::size_t>(index));
    }

private:
    const std::size_t eye_bytes_;
    const std::size_t rows_;
    std::vector<std::vector<std::uint8_t>> buffers_;
    std::mutex mutex_;
    LoanPool free_;
};

}  // namespace disparityd::capture
