// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "capture/frame_source.h"

namespace disparityd::capture {

/// Records in a thread of its own, so that whoever offers frames is never held up. Owns a bounded set of frame
/// buffers, allocated at the start; a frame that finds none free is lost and counted, and the next one recorded
/// carries that number in dropped_before. offer() is called by one thread, the rest from any.
class Recorder {
public:
    /// Throws as RecordingWriter does.
    Recorder(const std::string& path, const SourceInfo& info, std::size_t buffers = 16, bool overwrite = false);
    ~Recorder();  ///< as finish(), without reporting
    Recorder(const Recorder&) = delete;
    Recorder& operator=(const Recorder&) = delete;

    /// Copies the frame into a free buffer; false when it was lost (all buffers full, or the recorder has failed).
    bool offer(const RawFrame& frame) noexcept;

    struct Status {
        std::uint64_t frames = 0;       ///< written
        std::uint64_t lost = 0;         ///< offered, but not written
        std::uint64_t bytes = 0;        ///< of the file
        double seconds = 0;             ///< since the start
        std::string error;              ///< why it stopped by itself; empty = it did not
        std::uint64_t source_lost = 0;  ///< by the source, between the first and the last that were offered
    };
    Status status() const;

    /// Writes what is waiting, closes the file and returns the final numbers. Safe to call twice.
    Status finish();

    /// One line for people whose recording loses frames.
    static std::string slow_disk_text(const std::string& path);

private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace disparityd::capture
