// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "capture/recording/recording_ffmpeg.h"

namespace disparityd::capture {

/// The file under a muxer. FFmpeg writes through it; it keeps the system's reason when that fails.
class RecordingFile {
public:
    /// Throws std::invalid_argument when the file exists and may not be overwritten, std::runtime_error when another
    /// process writes it (base/file_lock.h) or the system refuses.
    RecordingFile(const std::string& path, bool overwrite);
    ~RecordingFile();
    RecordingFile(const RecordingFile&) = delete;
    RecordingFile& operator=(const RecordingFile&) = delete;

    AVIOContext* io() const { return io_; }
    bool seekable() const { return seekable_; }
    int error() const { return error_; }  ///< errno of the first write that failed; 0 = none
    std::uint64_t size() const { return size_; }

    /// Read and correct bytes that were written. Both bypass FFmpeg's buffer: flush that before.
    std::vector<std::uint8_t> read_head(std::size_t count) const;
    bool overwrite(std::uint64_t offset, std::span<const std::uint8_t> bytes) noexcept;

    /// Cuts the file; nothing is written through io() afterwards.
    bool cut(std::uint64_t size) noexcept;

    /// False when the system reports a failed write only now.
    bool close() noexcept;

    /// Deletes a file that holds nothing yet, unless it existed when it was opened.
    void discard() noexcept;

private:
    void claim();
    int write(const std::uint8_t* bytes, int count) noexcept;
    std::int64_t seek(std::int64_t offset, int whence) noexcept;

    std::string path_;
    int fd_ = -1;
    bool existed_ = false;
    bool seekable_ = false;
    int error_ = 0;
    std::uint64_t position_ = 0;
    std::uint64_t size_ = 0;
    AVIOContext* io_ = nullptr;
};

}  // namespace disparityd::capture
