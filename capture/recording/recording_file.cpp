// SPDX-License-Identifier: Apache-2.0
#include "capture/recording/recording_file.h"

#include <algorithm>
#include <cerrno>
#include <stdexcept>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file_lock.h"
#include "base/write_failure.h"

namespace disparityd::capture {
namespace {

constexpr int buffer_size = 256 * 1024;

int open_for_writing(const std::string& path, bool overwrite, bool& existed) {
    // Other users of the machine must not see what the camera saw.
    const int fd = ::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0640);
    if (fd >= 0 || errno != EEXIST || !overwrite) {
        return fd;
    }
    existed = true;
    // Write-only suffices for pipes and devices, where reading back would mean something else.
    struct stat status {};
    const bool regular = ::stat(path.c_str(), &status) == 0 && S_ISREG(status.st_mode);
    return ::open(path.c_str(), (regular ? O_RDWR : O_WRONLY) | O_CLOEXEC);
}

}  // namespace

RecordingFile::RecordingFile(const std::string& path, bool overwrite) : path_(path) {
    fd_ = open_for_writing(path, overwrite, existed_);
    if (fd_ < 0) {
        const int error = errno;
        if (error == EEXIST) {
            throw std::invalid_argument(path + ": exists already; choose another name");
        }
        base::refuse_to_write(path, error);
    }
    struct stat status {};
    seekable_ = ::fstat(fd_, &status) == 0 && S_ISREG(status.st_mode);
    if (seekable_) {
        claim();
    }

    using Bytes = std::uint8_t;
#if LIBAVFORMAT_VERSION_MAJOR >= 61
    using Given = const Bytes;
#else
    using Given = Bytes;
#endif
    auto* buffer = static_cast<Bytes*>(av_malloc(buffer_size));
    io_ = buffer == nullptr ? nullptr
                            : avio_alloc_context(
                                  buffer, buffer_size, 1, this, nullptr,
                                  [](void* self, Given* bytes, int count) {
                                      return static_cast<RecordingFile*>(self)->write(bytes, count);
                                  },
                                  [](void* self, std::int64_t offset, int whence) {
                                      return static_cast<RecordingFile*>(self)->seek(offset, whence);
                                  });
    if (io_ == nullptr) {
        av_free(buffer);
        close();
        throw std::bad_alloc();
    }
    io_->seekable = seekable_ ? AVIO_SEEKABLE_NORMAL : 0;
}

/// Empties the file, after the lock has shown that nobody else writes it.
void RecordingFile::claim() {
    try {
        base::lock_for_writing(fd_, path_);
    } catch (...) {
        close();
        throw;
    }
    if (existed_ && ::ftruncate(fd_, 0) != 0) {
        const int error = errno;
        close();
        base::refuse_to_write(path_, error);
    }
}

RecordingFile::~RecordingFile() {
    close();
    av_freep(&io_->buffer);
    avio_context_free(&io_);
}

bool RecordingFile::look() noexcept {
    struct stat status {};
    if (!seekable_ || state_ != State::whole || ::fstat(fd_, &status) != 0) {
        return state_ == State::whole;
    }
    if (status.st_nlink == 0) {
        state_ = State::removed;
        size_ = 0;
    } else if (static_cast<std::uint64_t>(status.st_size) < size_) {
        state_ = State::cut;
        size_ = static_cast<std::uint64_t>(status.st_size);
    }
    return state_ == State::whole;
}

int RecordingFile::write(const std::uint8_t* bytes, int count) noexcept {
    if (error_ == 0 && !look()) {  // a write into a file that was cut would leave a hole
        error_ = EIO;
    }
    if (error_ != 0) {
        return AVERROR(error_);
    }
    int done = 0;
    while (done < count) {
        const ssize_t written = ::write(fd_, bytes + done, static_cast<std::size_t>(count - done));
        if (written < 0) {
            if (errno == EINTR) {
                continue;
            }
            error_ = errno;
            return AVERROR(error_);
        }
        done += static_cast<int>(written);
        position_ += static_cast<std::uint64_t>(written);
        size_ = std::max(size_, position_);
    }
    return count;
}

std::int64_t RecordingFile::seek(std::int64_t offset, int whence) noexcept {
    if (!seekable_) {
        return AVERROR(ESPIPE);
    }
    if ((whence & AVSEEK_SIZE) != 0) {
        return static_cast<std::int64_t>(size_);
    }
    const off_t now = ::lseek(fd_, static_cast<off_t>(offset), whence & ~AVSEEK_FORCE);
    if (now < 0) {
        return AVERROR(errno);
    }
    position_ = static_cast<std::uint64_t>(now);
    return now;
}

std::size_t RecordingFile::read(std::uint64_t offset, std::span<std::uint8_t> bytes) const noexcept {
    const ssize_t got = seekable_ ? ::pread(fd_, bytes.data(), bytes.size(), static_cast<off_t>(offset)) : 0;
    return got > 0 ? static_cast<std::size_t>(got) : 0;
}

bool RecordingFile::overwrite(std::uint64_t offset, std::span<const std::uint8_t> bytes) noexcept {
    return seekable_ &&
           ::pwrite(fd_, bytes.data(), bytes.size(), static_cast<off_t>(offset)) == static_cast<ssize_t>(bytes.size());
}

bool RecordingFile::cut(std::uint64_t size) noexcept {
    if (!seekable_ || ::ftruncate(fd_, static_cast<off_t>(size)) != 0) {
        return false;
    }
    size_ = size;
    return true;
}

bool RecordingFile::close() noexcept {
    if (fd_ < 0) {
        return true;
    }
    const int result = ::close(fd_);
    if (result != 0 && error_ == 0) {
        error_ = errno;
    }
    fd_ = -1;
    return result == 0;
}

void RecordingFile::discard() noexcept {
    if (!existed_ && seekable_) {
        ::unlink(path_.c_str());
    }
}

}  // namespace disparityd::capture
