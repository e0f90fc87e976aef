// SPDX-License-Identifier: Apache-2.0
#include "capture/recorder.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <exception>
#include <limits>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "capture/recording_writer.h"
#include "capture/start_thread.h"

namespace disparityd::capture {
namespace {

using Clock = std::chrono::steady_clock;

/// Buffer numbers in order, without allocating after the start.
class NumberRing {
public:
    explicit NumberRing(std::size_t capacity) : numbers_(capacity) {}

    bool empty() const { return count_ == 0; }
    void push(std::size_t number) { numbers_[(first_ + count_++) % numbers_.size()] = number; }

    std::size_t pop() {
        const std::size_t number = numbers_[first_];
        first_ = (first_ + 1) % numbers_.size();
        --count_;
        return number;
    }

private:
    std::vector<std::size_t> numbers_;
    std::size_t first_ = 0;
    std::size_t count_ = 0;
};

std::size_t checked(std::size_t buffers) {
    if (buffers < 1) {
        throw std::invalid_argument("a recorder needs at least 1 frame buffer, found 0");
    }
    return buffers;
}

}  // namespace

class Recorder::Impl {
public:
    Impl(const std::string& path, const SourceInfo& info, std::size_t buffers, bool overwrite)
        : writer_(path, info, overwrite),
          format_(info.format),
          eye_width_(info.eye_width),
          height_(info.height),
          row_bytes_(2 * static_cast<std::size_t>(info.eye_width) *
                     static_cast<std::size_t>(bytes_per_pixel(info.format))),
          buffers_(buffers),
          free_(buffers),
          full_(buffers) {
        for (std::size_t i = 0; i < buffers_.size(); ++i) {
            buffers_[i].pixels.resize(row_bytes_ * static_cast<std::size_t>(height_));
            buffers_[i].sensors.reserve(RawFrame::most_samples);
            free_.push(i);
        }
        status_.bytes = writer_.bytes();
        thread_ = start_thread([this] { run(); });
    }

    ~Impl() { finish(); }
    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;

    bool offer(const RawFrame& frame) noexcept {
        const RawImage& image = frame.image;
        const bool fits = image.format == format_ && image.eye_width == eye_width_ && image.height == height_;
        std::size_t number = 0;
        {
            const std::lock_guard lock(mutex_);
            status_.source_lost += offered_ ? frame.dropped_before : 0;
            offered_ = true;
            if (!fits || failed_ || finishing_ || free_.empty()) {
                ++status_.lost;
                ++lost_before_next_;
                samples_lost_before_next_ += count_of(frame.sensors);
                return false;
            }
            number = free_.pop();
            copying_ = true;
        }
        Buffer& buffer = buffers_[number];  // nobody else knows this buffer now
        for (int y = 0; y < height_; ++y) {
            std::memcpy(buffer.pixels.data() + static_cast<std::size_t>(y) * row_bytes_, image.data + y * image.stride,
                        row_bytes_);
        }
        buffer.frame = frame;
        buffer.frame.image.data = buffer.pixels.data();
        buffer.frame.image.stride = static_cast<std::ptrdiff_t>(row_bytes_);
        const auto samples = frame.sensors.first(std::min(frame.sensors.size(), RawFrame::most_samples));
        buffer.sensors.assign(samples.begin(), samples.end());
        buffer.frame.sensors = buffer.sensors;
        const std::lock_guard lock(mutex_);
        copying_ = false;
        if (ended_) {
            ++status_.lost;
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

    Status status() const {
        const std::lock_guard lock(mutex_);
        Status status = status_;
        if (!ended_) {
            status.seconds = std::chrono::duration<double>(Clock::now() - start_).count();
        }
        return status;
    }

    Status finish() {
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

private:
    struct Buffer {
        std::vector<std::uint8_t> pixels;
        std::vector<SensorSample> sensors;
        RawFrame frame;
    };

    static std::uint32_t count_of(std::span<const SensorSample> samples) {
        std::uint32_t count = 0;
        for (const SensorSample& sample : samples) {
            count += 1 + sample.lost_before;
        }
        return count;
    }

    void run() {
        std::string error;
        try {
            write_all();
        } catch (const std::exception& problem) {
            error = problem.what();
        }
        try {
            writer_.close();
        } catch (const std::exception& problem) {
            if (error.empty()) {
                error = problem.what();
            }
        }
        const std::lock_guard lock(mutex_);
        failed_ = true;
        ended_ = true;
        // Frames that the writer took back with a failed cluster are lost, as are those that still wait.
        status_.lost += taken_ - writer_.frames();
        for (; !full_.empty(); full_.pop()) {
            ++status_.lost;
        }
        status_.frames = writer_.frames();
        status_.bytes = writer_.bytes();
        status_.error = error;
        status_.seconds = std::chrono::duration<double>(Clock::now() - start_).count();
    }

    void write_all() {
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
            free_.push(number);
            status_.frames = writer_.frames();
            status_.bytes = writer_.bytes();
        }
    }

    RecordingWriter writer_;  // of the recorder's thread after the start
    const PixelFormat format_;
    const int eye_width_;
    const int height_;
    const std::size_t row_bytes_;
    std::vector<Buffer> buffers_;

    mutable std::mutex mutex_;
    std::condition_variable changed_;
    NumberRing free_;
    NumberRing full_;
    Status status_;
    std::uint64_t lost_before_next_ = 0;
    std::uint32_t samples_lost_before_next_ = 0;
    std::uint64_t taken_ = 0;  ///< given to the writer
    bool offered_ = false;     ///< there was a frame
    bool copying_ = false;     ///< offer() fills a buffer that is in neither ring
    bool finishing_ = false;
    bool failed_ = false;  ///< takes no more frames
    bool ended_ = false;

    const Clock::time_point start_ = Clock::now();
    std::mutex joining_;
    std::thread thread_;
};

Recorder::Recorder(const std::string& path, const SourceInfo& info, std::size_t buffers, bool overwrite)
    : impl_(std::make_unique<Impl>(path, info, checked(buffers), overwrite)) {}

Recorder::~Recorder() = default;

bool Recorder::offer(const RawFrame& frame) noexcept {
    return impl_->offer(frame);
}

Recorder::Status Recorder::status() const {
    return impl_->status();
}

Recorder::Status Recorder::finish() {
    return impl_->finish();
}

std::string Recorder::slow_disk_text(const std::string& path) {
    return path +
           ": frames come faster than they can be written and are lost: record to a faster disk, or in a smaller mode "
           "or at a lower rate";
}

}  // namespace disparityd::capture
