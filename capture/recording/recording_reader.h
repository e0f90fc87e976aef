// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "capture/recording/recording_format.h"
#include "kernels/raw_image.h"

namespace disparityd::capture {

/// Reads a recording, any video of both eyes that FFmpeg can read, or a bag, from its first frame to its last. One
/// thread uses an object at a time.
class RecordingReader {
public:
    RecordingReader() = default;
    virtual ~RecordingReader() = default;
    RecordingReader(const RecordingReader&) = delete;
    RecordingReader& operator=(const RecordingReader&) = delete;

    struct Info {
        PixelFormat format = PixelFormat::grey8;
        int eye_width = 0;  ///< pixels
        int height = 0;
        double rate = 0;  ///< frames per second; 0 = unknown
        std::optional<std::uint64_t> frame_count;
        std::string content;     ///< for people: "recording of scene:vga", "h264 video"
        bool synthetic = false;  ///< drawn frames were recorded
        int time_offset_us = 0;  ///< that the stamps contain
        std::optional<std::string> calibration_text;
        std::string calibration_origin{};    ///< the file that it was read from; empty: the recording itself
        std::string serial{};                ///< of the camera whose calibration that is; empty: unknown
        std::vector<std::string> notices{};  ///< one line each: what was assumed about the video
    };

    /// Constant from open to close.
    virtual const Info& info() const = 0;

    virtual std::size_t frame_bytes() const = 0;

    /// Reads one frame into frame_bytes() at `pixels`, rows without gaps; false after the last one. Throws
    /// std::runtime_error when the file is damaged or cut, after everything whole was read.
    virtual bool read(recording::FrameFacts& facts, std::uint8_t* pixels) = 0;

    /// Makes a read() that waits for something else than a file return false. Any thread.
    virtual void interrupt() noexcept {}
};

/// Returns whether a text names two files with a comma between them, of which one at least is there.
bool is_pair_of_videos(const std::string& uri);

/// Opens a file with the reader that its tags ask for: a recording, a side-by-side video, a video with a track for each
/// eye, or two videos as "left.mp4,right.mp4". Throws std::invalid_argument with one line when this is no video
/// that can be taken, std::runtime_error when the system refuses to read it.
std::unique_ptr<RecordingReader> open_recording_reader(const std::string& path);

}  // namespace disparityd::capture
