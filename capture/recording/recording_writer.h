// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "capture/frame_source.h"

namespace disparityd::capture {

/// Writes a recording: Matroska, one video stream, lossless side by side or a camera's own JPEGs, exact times, sequence
/// and flags of each frame, and the calibration, all in one file. One thread uses an object at a time.
class RecordingWriter {
public:
    /// `info` describes the frames to come (format, size, rate, calibration, name). Throws std::runtime_error with one
    /// line when the file cannot be made, std::invalid_argument when it exists and `overwrite` is not set, or when
    /// frames of this size cannot be recorded.
    RecordingWriter(const std::string& path, const SourceInfo& info, bool overwrite = false);
    ~RecordingWriter();  ///< closes without reporting errors
    RecordingWriter(const RecordingWriter&) = delete;
    RecordingWriter& operator=(const RecordingWriter&) = delete;

    /// Compresses and appends one frame. Throws std::runtime_error (disk full, ...); what was written before, up to
    /// half a second less, stays in the file, which is whole and readable then; frames() says how much that is.
    /// Frames reach the file in groups of at most half a second: what a killed process loses.
    void write(const RawFrame& frame);

    /// Finishes the file (index, duration). Throws std::runtime_error when the last bytes cannot be written.
    void close();

    std::uint64_t frames() const;  ///< taken so far; after an error, those that the file keeps
    std::uint64_t bytes() const;   ///< of the file so far

private:
    /// Hidden, so that whoever includes this header needs no libavcodec and libavformat.
    class Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace disparityd::capture
