// SPDX-License-Identifier: Apache-2.0
#include "capture/folder_source.h"

#include <algorithm>
#include <condition_variable>
#include <cstring>
#include <mutex>
#include <stdexcept>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "capture/calibration_formats.h"
#include "capture/image_files.h"
#include "capture/image_sequence.h"
#include "capture/text_file.h"

namespace disparityd::capture {

namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::nanoseconds;

constexpr double untimed_rate = 10;
constexpr std::int64_t untimed_period_ns = 100'000'000;
constexpr std::int64_t epoch_ns = 946'684'800'000'000'000;  // 2000-01-01, UTC
constexpr nanoseconds latest = std::chrono::seconds(1);

ImageSize size_of(const cv::Mat& image) {
    return {image.cols, image.rows};
}

void check_sizes(const ImageSequence& sequence, ImageSize expected) {
    const std::string& first = sequence.frames.front().left;
    for (const ImageSequence::Frame& frame : sequence.frames) {
        for (const std::string* path : {&frame.left, &frame.right}) {
            const auto size = path->empty() ? std::nullopt : peek_image_size(*path);
            if (size && *size != expected) {
                throw std::invalid_argument(unequal_sizes(first, expected, *path, *size));
            }
        }
    }
}

std::optional<StereoCalibration> find_calibration(const SourceOptions& options, const ImageSequence& sequence,
                                                  int width, int height) {
    if (!options.calibration_path.empty()) {
        return read_calibration(options.calibration_path, width, height);
    }
    if (!sequence.calibration.empty()) {
        const std::string& path = sequence.calibration;
        if (sequence.kitti_camera >= 0) {
            const StereoCalibration calibration =
                read_kitti_calibration(path, read_text_file(path, "calibration"), sequence.kitti_camera, width, height);
            check_plausible(calibration, path);
            return calibration;
        }
        return read_calibration(path, width, height);
    }
    if (!sequence.rectified) {
        return std::nullopt;
    }
    StereoCalibration calibration;  // rectified, but nothing is known of distances
    calibration.width = width;
    calibration.height = height;
    calibration.rectified = true;
    calibration.origin = options.uri;
    return calibration;
}

class FolderSource final : public FrameSource {
public:
    explicit FolderSource(const SourceOptions& options) : options_(options), images_(find_images(options.uri)) {
        if (options.loans < 1) {
            throw std::invalid_argument(options.uri + ": at least 1 frame must be on loan at a time, found " +
                                        std::to_string(options.loans));
        }
        const ImageSequence::Frame& first = images_.frames.front();
        const cv::Mat left = read_image(first.left);
        const cv::Mat right = first.right.empty() ? cv::Mat() : read_image(first.right);
        if (!right.empty() && right.size() != left.size()) {
            throw std::invalid_argument(unequal_sizes(first.left, size_of(left), first.right, size_of(right)));
        }
        if (right.empty() && left.cols % 2 != 0) {
            throw std::invalid_argument(first.left + ": both eyes side by side need an even width, found " +
                                        std::to_string(left.cols));
        }
        check_sizes(images_, size_of(left));
        size_ = size_of(left);
        describe(right.empty() ? left.cols / 2 : left.cols, left.channels() > 1 || right.channels() > 1);
        buffers_.resize(static_cast<std::size_t>(options.loans));
        for (std::size_t i = 0; i < buffers_.size(); ++i) {
            buffers_[i].create(info_.height, 2 * info_.eye_width, channels() == 3 ? CV_8UC3 : CV_8UC1);
            free_.push_back(i);
        }
    }

    const SourceInfo& info() const override { return info_; }

    Next next(RawFrame& frame, Clock::time_point deadline) override {
        std::size_t buffer = 0;
        {
            std::unique_lock lock(mutex_);
            const Next state = wait_for_turn(lock, deadline);
            if (state != Next::frame) {
                return state;
            }
            buffer = free_.back();
            free_.pop_back();
        }
        try {
            decode(buffers_[buffer]);
        } catch (const std::exception& problem) {
            const std::lock_guard lock(mutex_);
            free_.push_back(buffer);
            ended_ = true;
            throw std::runtime_error(problem.what());
        }
        fill(frame, buffer);
        advance();
        return Next::frame;
    }

    void give_back(const RawFrame& frame) noexcept override {
        const std::lock_guard lock(mutex_);
        free_.push_back(static_cast<std::size_t>(frame.loan));  // within its capacity: see the constructor
        changed_.notify_all();
    }

    void interrupt() noexcept override {
        const std::lock_guard lock(mutex_);
        interrupted_ = true;
        changed_.notify_all();
    }

private:
    int channels() const { return bytes_per_pixel(info_.format); }

    void describe(int eye_width, bool colour) {
        info_.name = options_.uri;
        info_.format = colour ? PixelFormat::bgr24 : PixelFormat::grey8;
        info_.eye_width = eye_width;
        info_.height = size_.height;
        info_.rate = untimed_rate;
        const std::size_t count = images_.frames.size();
        if (images_.timed) {
            const std::int64_t span = images_.frames.back().time_ns - images_.frames.front().time_ns;
            info_.rate = span > 0 ? static_cast<double>(count - 1) * 1e9 / static_cast<double>(span) : 0;
        }
        if (!options_.loop) {
            info_.frame_count = count;
        }
        info_.calibration = find_calibration(options_, images_, info_.eye_width, info_.height);
        info_.description = images_.description + ", " + std::to_string(info_.eye_width) + " x " +
                            std::to_string(info_.height) + " per eye, " + (colour ? "colour" : "grey") + ", " +
                            std::to_string(count) + (count == 1 ? " frame" : " frames");
    }

    Next wait_for_turn(std::unique_lock<std::mutex>& lock, Clock::time_point deadline) {
        for (;;) {
            if (interrupted_) {
                return Next::interrupted;
            }
            if (ended_ || at_ == images_.frames.size()) {
                return Next::end;
            }
            Clock::time_point until = deadline;
            if (!free_.empty()) {
                const Clock::time_point due = due_time();
                if (due <= Clock::now()) {
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

    /// When the next frame is due: as long after the one before as the folder says.
    Clock::time_point due_time() {
        if (options_.pace == Pace::fastest) {
            return Clock::time_point::min();
        }
        if (!due_) {
            const Clock::time_point now = Clock::now();
            const bool timed_step = images_.timed && at_ > 0;
            const std::int64_t step =
                timed_step ? images_.frames[at_].time_ns - images_.frames[at_ - 1].time_ns : untimed_period_ns;
            due_ = sequence_ == 0 ? now : last_due_ + nanoseconds(step);
            if (now - *due_ > latest) {
                due_ = now;  // a taker that was away gets no burst of frames
            }
        }
        return *due_;
    }

    void decode(cv::Mat& both) const {
        const ImageSequence::Frame& frame = images_.frames[at_];
        if (frame.right.empty()) {
            decode(frame.left, both);
            return;
        }
        cv::Mat left = both.colRange(0, info_.eye_width);
        cv::Mat right = both.colRange(info_.eye_width, 2 * info_.eye_width);
        decode(frame.left, left);
        decode(frame.right, right);
    }

    void decode(const std::string& path, cv::Mat& into) const {
        const cv::Mat image = read_image(path);
        if (size_of(image) != size_) {
            throw std::invalid_argument(unequal_sizes(images_.frames.front().left, size_, path, size_of(image)));
        }
        if (image.channels() == into.channels()) {
            image.copyTo(into);
        } else {
            cv::cvtColor(image, into, image.channels() == 1 ? cv::COLOR_GRAY2BGR : cv::COLOR_BGR2GRAY);
        }
    }

    void fill(RawFrame& frame, std::size_t buffer) const {
        const cv::Mat& both = buffers_[buffer];
        frame = RawFrame();
        frame.image = {both.data, info_.format, info_.eye_width, info_.height, static_cast<std::ptrdiff_t>(both.step)};
        frame.sequence = sequence_;
        if (images_.timed) {
            frame.monotonic_ns = images_.frames[at_].time_ns - images_.frames.front().time_ns;
            // Bare seconds are no date.
            frame.realtime_ns = std::max(images_.frames[at_].time_ns, epoch_ns + frame.monotonic_ns);
        } else {
            frame.monotonic_ns = static_cast<std::int64_t>(sequence_) * untimed_period_ns;
            frame.realtime_ns = epoch_ns + frame.monotonic_ns;
        }
        frame.flags = sequence_ > 0 && at_ == 0 ? frame_flag_discontinuity : frame_flag_none;
        frame.loan = static_cast<int>(buffer);
    }

    void advance() {
        ++sequence_;
        ++at_;
        if (at_ == images_.frames.size() && options_.loop) {
            at_ = 0;
        }
        last_due_ = due_.value_or(last_due_);
        due_.reset();
    }

    const SourceOptions options_;
    const ImageSequence images_;
    SourceInfo info_;
    ImageSize size_;  ///< of one file

    // Of the thread that calls next().
    std::size_t at_ = 0;
    std::uint64_t sequence_ = 0;
    std::optional<Clock::time_point> due_;
    Clock::time_point last_due_;
    bool ended_ = false;
    std::vector<cv::Mat> buffers_;  ///< each belongs to whoever has it on loan

    std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<std::size_t> free_;
    bool interrupted_ = false;
};

}  // namespace

std::unique_ptr<FrameSource> open_images(const SourceOptions& options) {
    return std::make_unique<FolderSource>(options);
}

}  // namespace disparityd::capture
