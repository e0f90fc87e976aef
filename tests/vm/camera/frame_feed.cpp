// SPDX-License-Identifier: Apache-2.0
#include "tests/vm/camera/frame_feed.h"

#include <fstream>
#include <iterator>
#include <stdexcept>

#include "tests/vm/camera/test_pattern.h"

namespace simulated_camera {

FrameFeed::FrameFeed(const std::string& file) : from_file_(!file.empty()) {
    if (!from_file_) {
        return;
    }
    std::ifstream stream(file, std::ios::binary);
    if (!stream) {
        throw std::runtime_error(file + ": cannot be read");
    }
    file_.assign(std::istreambuf_iterator<char>(stream), {});
}

std::span<const std::uint8_t> FrameFeed::frame(std::uint32_t number, std::size_t frame_bytes) {
    const std::size_t frames_in_file = file_.size() / frame_bytes;
    if (frames_in_file > 0) {
        return std::span(file_).subspan(number % frames_in_file * frame_bytes, frame_bytes);
    }
    made_.assign(frame_bytes, 0);
    if (!from_file_) {
        fill_pattern(number, made_);
    }
    return made_;
}

}  // namespace simulated_camera
