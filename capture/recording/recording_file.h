// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "capture/recording/recording_ffmpeg.h"

namespace disparityd::capture {

/// The file under a muxer. FFmpeg writes through it; it keeps the system's reason when that fails. It notices when
/// another program removes or cuts the file meanwhile, which the system lets happen without a word.
class RecordingFile {
public:
    enum class State : unsigned char {
        whole,
        removed,  ///< it has no name any more
        cut,      ///< it is shorter than what was written
    };

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
    State state() const { return state_; }  ///< at the last look

    /// Looks whether all that was written is still there, as every write does before; returns false when it is not.
    bool look() noexcept;

    /// Reads bytes that were written, or fewer where the file ends. Bypasses FFmpeg's buffer: flush that before.
    std::size_t read(std::uint64_t offset, std::span<std::uint8_t> bytes) const noexcept;

    /// Corrects bytes that were written. Bypasses FFmpeg's buffer: flush that before.
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
    State state_ = State::whole;
    std::uint64_t position_ = 0;
    std::uint64_t size_ = 0;
    AVIOContext* io_ = nullptr;
};

}  // namespace disparityd::capture
