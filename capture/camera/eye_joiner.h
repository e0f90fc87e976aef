// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstring>
#include <mutex>
#include <vector>

#include "capture/eye_layout.h"
#include "capture/loan_pool.h"

namespace disparityd::capture {

/// Puts eyes that came one above the other, interleaved, or the right one first, side by side with the left one first,
/// into buffers of its own that are lent in turn. give_back() by any thread, the rest by one.
class EyeJoiner {
public:
    EyeJoiner(const EyeLayout& layout, int bytes_per_pixel, int buffers)
        : layout_(layout),
          eye_bytes_(static_cast<std::size_t>(layout.eye_width) * static_cast<std::size_t>(bytes_per_pixel)),
          rows_(static_cast<std::size_t>(layout.eye_height)),
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
        if (layout_.interleaved) {
            part(frame, stride, to);
            return static_cast<int>(index);
        }
        const auto second =
            layout_.top_bottom ? stride * static_cast<std::ptrdiff_t>(rows_) : static_cast<std::ptrdiff_t>(eye_bytes_);
        const std::ptrdiff_t left = layout_.right_first ? second : 0;
        for (std::size_t row = 0; row < rows_; ++row, frame += stride, to += 2 * eye_bytes_) {
            std::memcpy(to, frame + left, eye_bytes_);
            std::memcpy(to + eye_bytes_, frame + second - left, eye_bytes_);
        }
        return static_cast<int>(index);
    }

    const std::uint8_t* data(int index) const { return buffers_[static_cast<std::size_t>(index)].data(); }

    void give_back(int index) {
        const std::lock_guard lock(mutex_);
        free_.give_back(static_cast<std::size_t>(index));
    }

private:
    /// Takes pixels apart that have a byte of each eye.
    void part(const std::uint8_t* frame, std::ptrdiff_t stride, std::uint8_t* to) const {
        const std::size_t left = layout_.right_first ? 1 : 0;
        for (std::size_t row = 0; row < rows_; ++row, frame += stride, to += 2 * eye_bytes_) {
            for (std::size_t x = 0; x < eye_bytes_; ++x) {
                to[x] = frame[2 * x + left];
                to[eye_bytes_ + x] = frame[2 * x + 1 - left];
            }
        }
    }

    const EyeLayout layout_;
    const std::size_t eye_bytes_;
    const std::size_t rows_;
    std::vector<std::vector<std::uint8_t>> buffers_;
    std::mutex mutex_;
    LoanPool free_;
};

}  // namespace disparityd::capture
