// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <vector>

#include "capture/camera/camera_format.h"
#include "capture/eye_layout.h"
#include "capture/loan_pool.h"

namespace disparityd::capture {

/// Puts eyes that came one above the other, interleaved, or the right one first, side by side with the left one first,
/// and makes the pixels that are lent of those that were sent, in buffers of its own that are lent in turn. give_back()
/// by any thread, the rest by one.
class EyeJoiner {
public:
    /// `one_eye`: the frame shows one eye, whatever the layout says. `format` is borrowed.
    EyeJoiner(const EyeLayout& layout, const CameraFormat& format, int buffers, bool one_eye = false);

    bool has_room() {
        const std::lock_guard lock(mutex_);
        return free_.has_free();
    }

    /// Copies the frame into a buffer and returns its number. There must be room.
    int join(const std::uint8_t* frame, std::ptrdiff_t stride);

    const std::uint8_t* data(int index) const { return buffers_[static_cast<std::size_t>(index)].data(); }

    void give_back(int index) {
        const std::lock_guard lock(mutex_);
        free_.give_back(static_cast<std::size_t>(index));
    }

private:
    void part(const std::uint8_t* frame, std::ptrdiff_t stride, std::uint8_t* to) const;
    void put_eye(const std::uint8_t* eye, std::ptrdiff_t stride, std::uint8_t* to, std::size_t columns) const;

    const EyeLayout layout_;
    const CameraFormat& format_;
    const bool one_eye_;
    const std::size_t columns_;    ///< of an eye
    const std::size_t eye_bytes_;  ///< of a row, as it is lent
    const std::size_t rows_;
    std::vector<std::vector<std::uint8_t>> buffers_;
    std::mutex mutex_;
    LoanPool free_;
};

}  // namespace disparityd::capture
