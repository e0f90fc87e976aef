// SPDX-License-Identifier: Apache-2.0
#include "capture/camera/eye_joiner.h"

#include <cstring>

#include <opencv2/imgproc.hpp>

#include "capture/bayer.h"

namespace disparityd::capture {

namespace {

/// Takes a row apart that has a byte of each eye in turn.
void part_8(const std::uint8_t* row, std::size_t columns, std::uint8_t* first, std::uint8_t* second) {
    for (std::size_t x = 0; x < columns; ++x) {
        first[x] = row[2 * x];
        second[x] = row[2 * x + 1];
    }
}

/// Takes a row apart that has 12 bits of each eye in turn, and keeps the upper 8.
void part_12(const std::uint8_t* row, std::size_t columns, std::uint8_t* first, std::uint8_t* second) {
    for (std::size_t x = 0; x < columns; ++x, row += 3) {
        first[x] = static_cast<std::uint8_t>((row[0] >> 4U) | (row[1] << 4U));
        second[x] = row[2];
    }
}

}  // namespace

EyeJoiner::EyeJoiner(const EyeLayout& layout, const CameraFormat& format, int buffers, bool one_eye)
    : layout_(layout),
      format_(format),
      one_eye_(one_eye),
      columns_(static_cast<std::size_t>(layout.eye_width)),
      eye_bytes_(columns_ * static_cast<std::size_t>(bytes_per_pixel(format.lent))),
      rows_(static_cast<std::size_t>(layout.eye_height)),
      buffers_(static_cast<std::size_t>(buffers), std::vector<std::uint8_t>(2 * eye_bytes_ * rows_)),
      free_(buffers_.size()) {}

int EyeJoiner::join(const std::uint8_t* frame, std::ptrdiff_t stride) {
    std::size_t index = 0;
    {
        const std::lock_guard lock(mutex_);
        index = free_.take();
    }
    std::uint8_t* to = buffers_[index].data();
    if (format_.interleaved()) {
        part(frame, stride, to);
    } else if (one_eye_) {
        put_eye(frame, stride, to, 2 * columns_);
    } else {
        const std::ptrdiff_t second = layout_.top_bottom ? stride * static_cast<std::ptrdiff_t>(rows_)
                                                         : static_cast<std::ptrdiff_t>(columns_) * format_.bytes;
        const std::ptrdiff_t left = layout_.right_first ? second : 0;
        put_eye(frame + left, stride, to, columns_);
        put_eye(frame + second - left, stride, to + eye_bytes_, columns_);
    }
    return static_cast<int>(index);
}

void EyeJoiner::part(const std::uint8_t* frame, std::ptrdiff_t stride, std::uint8_t* to) const {
    const auto part_row = format_.packing == Packing::y12i ? part_12 : part_8;
    for (std::size_t row = 0; row < rows_; ++row, frame += stride, to += 2 * eye_bytes_) {
        std::uint8_t* right = to + eye_bytes_;
        part_row(frame, columns_, layout_.right_first ? right : to, layout_.right_first ? to : right);
    }
}

/// Writes the pixels of an eye to its place among rows of both eyes.
void EyeJoiner::put_eye(const std::uint8_t* eye, std::ptrdiff_t stride, std::uint8_t* to, std::size_t columns) const {
    if (format_.packing == Packing::bayer) {
        const int height = static_cast<int>(rows_);
        const int width = static_cast<int>(columns);
        const cv::Mat sent(height, width, CV_8UC1, const_cast<std::uint8_t*>(eye), static_cast<std::size_t>(stride));
        cv::Mat lent(height, width, CV_8UC3, to, 2 * eye_bytes_);
        cv::cvtColor(sent, lent, demosaicing(format_.blue_row, format_.blue_column));
        return;
    }
    for (std::size_t row = 0; row < rows_; ++row, eye += stride, to += 2 * eye_bytes_) {
        std::memcpy(to, eye, columns * static_cast<std::size_t>(format_.bytes));
    }
}

}  // namespace disparityd::capture
