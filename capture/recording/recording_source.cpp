// SPDX-License-Identifier: Apache-2.0
#include "capture/recording/recording_source.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <mutex>
#include <stdexcept>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "base/failure_text.h"
#include "base/start_thread.h"
#include "base/words.h"
#include "capture/loan_pool.h"
#include "capture/pacer.h"
#include "capture/pixel_format.h"
#include "capture/recording/number_ring.h"
#include "capture/recording/recording_reader.h"
#include "capture/shown_source.h"

namespace disparityd::capture {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::nanoseconds;

constexpr std::size_t decoded_ahead = 3;

std::string rate_text(double rate) {
    if (!(rate > 0)) {
        return "unknown rate";
    }
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.4g fps", rate);
    return text.data();
}

SourceInfo source_info(const SourceOptions& options, const RecordingReader::Info& found) {
    SourceInfo info;
    info.name = shown_source(options.uri);
    info.format = found.format;
    info.eye_width = found.eye_width;
    info.height = found.height;
    info.rate = found.rate;
    info.synthetic = found.synthetic;
    info.time_offset_us = found.time_offset_us;
    info.frame_count = options.loop ? std::nullopt : found.frame_count;
    info.description = found.content + ", " + std::to_string(info.eye_width) + " x " + std::to_string(info.height) +
                       " per eye, " + std::string(to_string(info.format)) + ", " + rate_text(info.rate);
    if (found.frame_count) {
        info.description += ", " + base::counted(*found.frame_count, "frame");
    }
    if (!options.calibration_path.empty()) {
        info.calibration = calibration::read_calibration(options.calibration_path, info.eye_width, info.height);
    } else if (found.calibration_text && options.calibrated) {
        info.calibration = calibration::calibration_from_text(
            *found.calibration_text, found.calibration_origin.empty() ? options.uri : found.calibration_origin);
        info.serial = found.serial;
    }
    return info;
}

class RecordingSource final : public FrameSource {
public:
    RecordingSource(const SourceOptions& options, const OpenReader& open_reader)
        : options_(options),
          open_reader_(open_reader),
          reader_(open_reader()),
          info_(source_info(options, reader_->info())),
          period_(info_.rate > 0 ? std::llround(1e9 / info_.rate) : 0) {
        if (options.loans < 1) {
            throw std::invalid_argument(options.uri + ": at least 1 frame must be on loan at a time, found " +
                                        std::to_string(options.loans));
        }
        for (const std::string& notice : reader_->info().notices) {
            if (options.report) {
                options.report(notice, false);
            }
        }
        buffers_.resize(static_cast<std::size_t>(options.loans) + decoded_ahead);
        for (Buffer& buffer : buffers_) {
            buffer.pixels.resize(reader_->frame_bytes());
        }
        free_ = LoanPool(buffers_.size());
        ready_ = NumberRing(buffers_.size());
        decoder_ = base::start_thread([this] { decode(); });
    }

    ~RecordingSource() override {
        {
            const std::lock_guard lock(mutex_);
            closing_ = true;
            reader_->interrupt();
        }
        buffer_free_.notify_all();
        decoder_.join();
    }
    RecordingSource(const RecordingSource&) = delete;
    RecordingSource& operator=(const RecordingSource&) = delete;

    const SourceInfo& info() const override { return info_; }

    Next next(RawFrame& frame, Clock::time_point deadline) override {
        std::unique_lock lock(mutex_);
        for (;;) {
            if (interrupted_) {
                return Next::interrupted;
            }
            if (ready_.empty() && ended_) {
                if (failure_) {
                    throw std::runtime_error(base::failure_text(std::exchange(failure_, nullptr)));
                }
                return Next::end;
            }
            Clock::time_point until = deadline;
            if (!ready_.empty() && on_loan_ < options_.loans) {
                const Clock::time_point due = due_of_first();
                if (due <= Clock::now()) {
                    lend(frame);
                    return Next::frame;
                }
                until = std::min(due, deadline);
            }
            if (deadline <= Clock::now()) {
                return Next::timeout;
            }
            changed_.wait_until(lock, until);
        }
    }

    void give_back(const RawFrame& frame) noexcept override {
        const std::lock_guard lock(mutex_);
        free_.give_back(static_cast<std::size_t>(frame.loan));
        --on_loan_;
        buffer_free_.notify_one();
        changed_.notify_one();
    }

    void interrupt() noexcept override {
        const std::lock_guard lock(mutex_);
        interrupted_ = true;
        reader_->interrupt();
        changed_.notify_all();
    }

private:
    struct Buffer {
        std::vector<std::uint8_t> pixels;
        recording::FrameFacts facts;
        bool new_round = false;
    };

    Clock::time_point due_of_first() {
        if (options_.pace == Pace::fastest) {
            return Clock::time_point::min();
        }
        if (!due_) {
            const Buffer& first = buffers_[ready_.front()];
            const std::int64_t time_ns = first.facts.monotonic_ns;
            const nanoseconds step = first.new_round ? period_ : recorded_step(last_time_ns_, time_ns, period_);
            due_ = pacer_.due(Clock::now(), step);
            last_time_ns_ = time_ns;
        }
        return *due_;
    }

    void lend(RawFrame& frame) {
        const std::size_t number = ready_.pop();
        due_.reset();
        ++on_loan_;
        const Buffer& buffer = buffers_[number];
        frame.image.data = buffer.pixels.data();
        frame.image.format = info_.format;
        frame.image.eye_width = info_.eye_width;
        frame.image.height = info_.height;
        frame.image.stride = 2 * static_cast<std::ptrdiff_t>(info_.eye_width) * bytes_per_pixel(info_.format);
        frame.sequence = buffer.facts.sequence;
        frame.monotonic_ns = buffer.facts.monotonic_ns;
        frame.realtime_ns = buffer.facts.realtime_ns;
        frame.flags = buffer.facts.flags;
        frame.dropped_before = buffer.facts.dropped_before;
        frame.correction = buffer.facts.correction;
        frame.sensors = buffer.facts.sensors;
        frame.loan = static_cast<int>(number);
    }

    void decode() noexcept {
        std::exception_ptr failure;
        try {
            while (decode_round() && options_.loop && !is_stopped()) {
                std::unique_ptr<RecordingReader> reader = open_reader_();
                {
                    const std::lock_guard lock(mutex_);
                    reader_.swap(reader);
                }
                reader.reset();
                if (reader_->frame_bytes() != buffers_[0].pixels.size()) {
                    throw std::runtime_error(options_.uri + ": was replaced by another one while it played");
                }
            }
        } catch (...) {
            failure = std::current_exception();  // its text would need memory, and there may be none
        }
        const std::lock_guard lock(mutex_);
        failure_ = std::move(failure);
        ended_ = true;
        changed_.notify_all();
    }

    bool is_stopped() {
        const std::lock_guard lock(mutex_);
        return interrupted_ || closing_;
    }

    /// Plays the recording once; false when there is no point in playing it again.
    bool decode_round() {
        const std::uint64_t base = next_sequence_;
        std::uint64_t first = 0;
        for (bool any = false;; any = true) {
            const std::optional<std::size_t> number = take_free();
            if (!number) {
                return false;
            }
            Buffer& buffer = buffers_[*number];
            if (!reader_->read(buffer.facts, buffer.pixels.data())) {
                const std::lock_guard lock(mutex_);
                free_.give_back(*number);
                return any;
            }
            buffer.new_round = !any && round_ > 0;
            if (!any) {
                first = buffer.facts.sequence;
                ++round_;
            }
            if (buffer.new_round) {
                buffer.facts.flags |= frame_flag_discontinuity;
            }
            if (round_ > 1) {
                buffer.facts.sequence = base + (buffer.facts.sequence - first);
            }
            next_sequence_ = buffer.facts.sequence + 1;
            const std::lock_guard lock(mutex_);
            ready_.push(*number);
            changed_.notify_one();
        }
    }

    std::optional<std::size_t> take_free() {
        std::unique_lock lock(mutex_);
        buffer_free_.wait(lock, [this] { return closing_ || free_.has_free(); });
        if (closing_) {
            return std::nullopt;
        }
        return free_.take();
    }

    const SourceOptions options_;
    const OpenReader open_reader_;
    std::unique_ptr<RecordingReader> reader_;  // of the decoding thread after the start, but for interrupt()
    const SourceInfo info_;
    const nanoseconds period_;         ///< 0 = unknown
    std::uint64_t next_sequence_ = 0;  // of the decoding thread
    std::uint64_t round_ = 0;          // of the decoding thread
    std::vector<Buffer> buffers_;      // each belongs to whoever holds its number

    std::mutex mutex_;
    std::condition_variable changed_;      ///< for next()
    std::condition_variable buffer_free_;  ///< for the decoding thread
    LoanPool free_{0};
    NumberRing ready_{1};
    Pacer pacer_;
    std::int64_t last_time_ns_ = 0;         ///< recorded time of the frame that pacer_ saw last
    std::optional<Clock::time_point> due_;  ///< of the first ready frame, once it was asked for
    int on_loan_ = 0;
    bool interrupted_ = false;
    bool closing_ = false;
    bool ended_ = false;
    std::exception_ptr failure_;
    std::thread decoder_;
};

}  // namespace

bool is_recording(const std::string& uri) {
    const std::string extension = base::lower_case(std::filesystem::path(uri).extension().string());
    constexpr std::array<std::string_view, 12> known{".mkv", ".mp4", ".mov",  ".avi", ".webm", ".m4v",
                                                     ".mpg", ".ts",  ".mpeg", ".y4m", ".ogv",  ".nut"};
    std::error_code error;
    return std::find(known.begin(), known.end(), extension) != known.end() ||
           std::filesystem::is_regular_file(uri, error) || is_pair_of_videos(uri);
}

std::unique_ptr<FrameSource> play(const SourceOptions& options, const OpenReader& open_reader) {
    return std::make_unique<RecordingSource>(options, open_reader);
}

std::unique_ptr<FrameSource> open_recording(const SourceOptions& options) {
    return play(options, [uri = options.uri] { return open_recording_reader(uri); });
}

}  // namespace disparityd::capture
