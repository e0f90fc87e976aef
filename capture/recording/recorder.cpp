// SPDX-License-Identifier: Apache-2.0
#include "capture/recording/recorder.h"

#include <algorithm>
#include <cstring>
#include <exception>
#include <limits>
#include <span>
#include <stdexcept>
#include <utility>

#include "base/failure_text.h"
#include "base/start_thread.h"

namespace disparityd::capture {
namespace {

using Clock = std::chrono::steady_clock;

std::size_t checked(std::size_t buffers) {
    if (buffers < 1) {
        throw std::invalid_argument("a recorder needs at least 1 frame buffer, found 0");
    }
    return buffers;
}

std::uint32_t count_of(std::span<const SensorSample> samples) {
    std::uint32_t count = 0;
    for (const SensorSample& sample : samples) {
        count += 1 + sample.lost_before;
    }
    return count;
}

}  // namespace

Recorder::Recorder(const std::string& path, const SourceInfo& info, std::size_t buffers, bool overwrite)
    : buffers_(checked(buffers)),
      writer_(path, info, overwrite),
      format_(info.format),
      eye_width_(info.eye_width),
      height_(info.height),
      jpegs_(info.jpegs.has_value()),
      row_bytes_(2 * static_cast<std::size_t>(info.eye_width) * static_cast<std::size_t>(bytes_per_pixel(info.format))),
      free_(buffers),
      full_(buffers) {
    for (Buffer& buffer : buffers_) {
        buffer.bytes.resize(row_bytes_ * static_cast<std::size_t>(height_));
        buffer.sensors.reserve(RawFrame::most_samples);
    }
    status_.bytes = writer_.bytes();
    thread_ = base::start_thread([this] { run(); });
}

Recorder::~Recorder() {
    finish();
}

/// A JPEG has fewer bytes than its pixels have, or it is none that a camera sends.
bool Recorder::fits(const RawFrame& frame) const {
    const RawImage& image = frame.image;
    return image.format == format_ && image.eye_width == eye_width_ && image.height == height_ &&
           (!jpegs_ || (!frame.jpeg.empty() && frame.jpeg.size() <= row_bytes_ * static_cast<std::size_t>(height_)));
}

void Recorder::copy(const RawFrame& frame, Buffer& buffer) const {
    buffer.frame = frame;
    if (jpegs_) {
        std::memcpy(buffer.bytes.data(), frame.jpeg.data(), frame.jpeg.size());
        buffer.frame.jpeg = std::span(buffer.bytes).first(frame.jpeg.size());
    } else {
        for (int y = 0; y < height_; ++y) {
            std::memcpy(buffer.bytes.data() + static_cast<std::size_t>(y) * row_bytes_,
                        frame.image.data + y * frame.image.stride, row_bytes_);
        }
        buffer.frame.image.data = buffer.bytes.data();
        buffer.frame.image.stride = static_cast<std::ptrdiff_t>(row_bytes_);
    }
    const auto samples = frame.sensors.first(std::min(frame.sensors.size(), RawFrame::most_samples));
    buffer.sensors.assign(samples.begin(), samples.end());
    buffer.frame.sensors = buffer.sensors;
}

bool Recorder::offer(const RawFrame& frame) noexcept {
    std::size_t number = 0;
    {
        const std::lock_guard lock(mutex_);
        status_.lost += offered_ ? frame.dropped_before : 0;
        offered_ = true;
        if (!fits(frame) || failed_ || finishing_ || !free_.has_free()) {
            ++status_.dropped;
            ++lost_before_next_;
            samples_lost_before_next_ += count_of(frame.sensors);
            return false;
        }
        number = free_.take();
        copying_ = true;
    }
    Buffer& buffer = buffers_[number];  // nobody else knows this buffer now
    copy(frame, buffer);
    const std::lock_guard lock(mutex_);
    copying_ = false;
    if (ended_) {
        ++status_.dropped;
        return false;
    }
    const std::uint64_t dropped = std::uint64_t{frame.dropped_before} + lost_before_next_;
    buffer.frame.dropped_before =
        static_cast<std::uint32_t>(std::min<std::uint64_t>(dropped, std::numeric_limits<std::uint32_t>::max()));
    lost_before_next_ = 0;
    if (!buffer.sensors.empty()) {
        buffer.sensors.front().lost_before += std::exchange(samples_lost_before_next_, 0);
    }
    full_.push(number);
    changed_.notify_one();
    return true;
}

Recorder::Status Recorder::status() const {
    const std::lock_guard lock(mutex_);
    Status status = status_;
    if (!ended_) {
        status.seconds = std::chrono::duration<double>(Clock::now() - start_).count();
    }
    return status;
}

Recorder::Status Recorder::finish() {
    {
        const std::lock_guard lock(mutex_);
        finishing_ = true;
    }
    changed_.notify_one();
    {
        const std::lock_guard lock(joining_);
        if (thread_.joinable()) {
            thread_.join();
        }
    }
    return status();
}

void Recorder::run() {
    std::exception_ptr failure;
    try {
        write_all();
    } catch (...) {
        failure = std::current_exception();
    }
    try {
        writer_.close();
    } catch (...) {
        if (!failure) {
            failure = std::current_exception();
        }
    }
    std::string error = failure ? base::failure_text(failure) : std::string();
    const std::lock_guard lock(mutex_);
    failed_ = true;
    ended_ = true;
    // Frames that the writer took back with a failed cluster are lost, as are those that still wait.
    status_.dropped += taken_ - writer_.frames();
    for (; !full_.empty(); full_.pop()) {
        ++status_.dropped;
    }
    status_.frames = writer_.frames();
    status_.bytes = writer_.bytes();
    status_.error = std::move(error);
    status_.seconds = std::chrono::duration<double>(Clock::now() - start_).count();
}

void Recorder::write_all() {
    for (;;) {
        std::size_t number = 0;
        {
            std::unique_lock lock(mutex_);
            changed_.wait(lock, [this] { return (finishing_ && !copying_) || !full_.empty(); });
            if (full_.empty()) {
                return;
            }
            number = full_.pop();
            ++taken_;
        }
        writer_.write(buffers_[number].frame);
        const std::lock_guard lock(mutex_);
        free_.give_back(number);
        status_.frames = writer_.frames();
        status_.bytes = writer_.bytes();
    }
}

std::string Recorder::slow_disk_text(const std::string& path) {
    return path +
           ": frames come faster than they can be written and are dropped: record to a faster disk, or in a smaller "
           "mode "
           "or at a lower rate";
}

}  // namespace disparityd::capture
