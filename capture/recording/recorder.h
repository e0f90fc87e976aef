// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "capture/frame_source.h"
#include "capture/loan_pool.h"
#include "capture/recording/number_ring.h"
#include "capture/recording/recording_writer.h"

namespace disparityd::capture {

/// Records in a thread of its own, so that offer() never waits for the disk. Its frame buffers are allocated at the
/// start. A frame that finds none free is lost and counted; the next recorded frame carries that number in
/// dropped_before. offer() is called by one thread, the rest from any.
class Recorder {
public:
    static constexpr std::size_t default_buffers = 16;

    /// Throws as RecordingWriter does.
    Recorder(const std::string& path, const SourceInfo& info, std::size_t buffers = default_buffers,
             bool overwrite = false);
    ~Recorder();  ///< as finish(), without reporting
    Recorder(const Recorder&) = delete;
    Recorder& operator=(const Recorder&) = delete;

    /// Copies the frame into a free buffer; false when it was lost (all buffers full, or the recorder has failed).
    bool offer(const RawFrame& frame) noexcept;

    struct Status {
        std::uint64_t frames = 0;   ///< written
        std::uint64_t dropped = 0;  ///< offered, but not written
        std::uint64_t bytes = 0;    ///< of the file
        double seconds = 0;         ///< since the start
        std::string error;          ///< why it stopped by itself; empty = it did not
        std::uint64_t lost = 0;     ///< by the source, between the first and the last that were offered
    };
    Status status() const;

    /// Writes what is waiting, closes the file and returns the final numbers. Safe to call twice.
    Status finish();

    /// One line for people whose recording loses frames.
    static std::string slow_disk_text(const std::string& path);

private:
    struct Buffer {
        std::vector<std::uint8_t> bytes;  ///< the pixels, or the JPEG
        std::vector<SensorSample> sensors;
        RawFrame frame;
    };

    bool fits(const RawFrame& frame) const;
    void copy(const RawFrame& frame, Buffer& buffer) const;
    void run();
    void write_all();

    std::vector<Buffer> buffers_;
    RecordingWriter writer_;  ///< of the recorder's thread after the start
    const PixelFormat format_;
    const int eye_width_;
    const int height_;
    const bool jpegs_;             ///< the camera's JPEGs are written, not the pixels
    const std::size_t row_bytes_;  ///< of both eyes

    mutable std::mutex mutex_;  ///< what follows, up to ended_
    std::condition_variable changed_;
    LoanPool free_;
    NumberRing full_;
    Status status_;
    std::uint64_t lost_before_next_ = 0;
    std::uint32_t samples_lost_before_next_ = 0;
    std::uint64_t taken_ = 0;  ///< frames given to the writer
    bool offered_ = false;     ///< there was a frame
    bool copying_ = false;     ///< offer() fills a buffer that is neither free nor full
    bool finishing_ = false;
    bool failed_ = false;  ///< takes no more frames
    bool ended_ = false;

    const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    std::mutex joining_;  ///< for thread_
    std::thread thread_;
};

}  // namespace disparityd::capture
