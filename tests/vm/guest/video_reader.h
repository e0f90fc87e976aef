// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "tests/vm/camera/file_descriptor.h"
#include "tests/vm/guest/waiting.h"

namespace vm_guest {

/// The plainest user of V4L2 that there can be: mapped buffers, one frame after the other. Calls that the kernel
/// refuses throw std::system_error, so that tests see the errno.
class VideoReader {
public:
    struct Size {
        std::uint32_t width;
        std::uint32_t height;
    };

    struct Frame {
        std::vector<std::uint8_t> bytes;  ///< as many as the driver says it filled
        std::uint32_t sequence = 0;
        std::uint32_t flags = 0;  ///< V4L2_BUF_FLAG_...
    };

    /// Opens the node and sets YUYV frames of this size, as slow as they come.
    VideoReader(const std::string& node, Size size);
    ~VideoReader();
    VideoReader(const VideoReader&) = delete;
    VideoReader& operator=(const VideoReader&) = delete;

    int descriptor() const { return device_.get(); }

    /// Sizes of YUYV frames that the camera offers.
    std::vector<Size> sizes() const;

    /// Takes buffers (EBUSY when another has them) and starts the stream.
    void start();
    void stop();

    /// Waits for a buffer. False when none comes in time.
    bool read(Frame& frame, milliseconds limit = patience);

private:
    void queue(std::uint32_t index);

    simulated_camera::FileDescriptor device_;
    std::vector<std::span<std::uint8_t>> buffers_;
};

/// Both eyes of the camera's smallest mode.
inline constexpr VideoReader::Size vga{1344, 376};

}  // namespace vm_guest
