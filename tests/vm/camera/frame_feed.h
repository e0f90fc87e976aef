// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace simulated_camera {

/// What the camera sees: raw frames of a file, over and over, or the numbered pattern.
class FrameFeed {
public:
    /// An empty name stands for the pattern. Throws std::runtime_error when the file cannot be read.
    explicit FrameFeed(const std::string& file);

    /// The frame with this number, valid until the next call. A file that holds less than one frame gives zeros.
    std::span<const std::uint8_t> frame(std::uint32_t number, std::size_t frame_bytes);

private:
    bool from_file_;
    std::vector<std::uint8_t> file_;
    std::vector<std::uint8_t> made_;
};

}  // namespace simulated_camera
