// SPDX-License-Identifier: Apache-2.0
#include "capture/images/folder_source.h"

#include <algorithm>
#include <bit>
#include <condition_variable>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <stdexcept>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "base/failure_text.h"
#include "base/message_text.h"
#include "base/text_file.h"
#include "base/words.h"
#include "calibration/formats/calibration_formats.h"
#include "capture/images/image_files.h"
#include "capture/images/image_sequence.h"
#include "capture/images/inertial_list.h"
#include "capture/loan_pool.h"
#include "capture/pacer.h"

namespace disparityd::capture {

namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::nanoseconds;

constexpr double untimed_rate = 10;
constexpr std::int64_t untimed_period_ns = 100'000'000;
constexpr std::int64_t epoch_ns = 946'684'800'000'000'000;  // 2000-01-01, UTC

ImageSize size_of(const cv::Mat& image) {
    return {image.cols, image.rows};
}

void check_sizes(const ImageSequence& sequence, ImageSize expected) {
    const std::string& first = sequence.frames.front().left;
    for (const ImageSequence::Frame& frame : sequence.frames) {
        for (const std::string* path : {&frame.left, &frame.right}) {
            const auto size = path->empty() ? std::nullopt : peek_image_size(*path);
            if (size && *size != expected) {
                throw std::invalid_argument(unequal_sizes(first, expected, *path, *size) +
                                            " (a pattern with %d can take those of one size)");
            }
        }
    }
}

/// What lies before the frames that are asked for.
struct Before {
    std::int64_t start_ns = 0;              ///< the time of the first of all
    std::optional<std::int64_t> before_ns;  ///< that of the frame before the first one that is asked for
};

/// Returns the frames that the options ask for.
ImageSequence asked_images(const SourceOptions& options, const ImageUri& uri, Before& before) {
    ImageSequence sequence = find_images(uri.path);
    if (!uri.inertial) {
        sequence.inertial_list.clear();
        sequence.inertial_calibration.clear();
    }
    auto& frames = sequence.frames;
    before.start_ns = frames.front().time_ns;
    if (options.first_image >= frames.size()) {
        throw std::invalid_argument(options.uri + ": image " + std::to_string(options.first_image) +
                                    " is asked for, the first is 0, found " + base::counted(frames.size(), "frame"));
    }
    if (options.first_image > 0) {
        before.before_ns = frames[options.first_image - 1].time_ns;
    }
    const std::size_t count = std::min(options.image_count, frames.size() - options.first_image);
    const auto begin = frames.begin() + static_cast<std::ptrdiff_t>(options.first_image);
    std::vector<ImageSequence::Frame>(begin, begin + static_cast<std::ptrdiff_t>(count)).swap(frames);
    return sequence;
}

calibration::StereoCalibration read_kitti(const std::string& path, int camera, int width, int height) {
    const calibration::StereoCalibration calibration =
        calibration::read_kitti_calibration(path, base::read_text_file(path, "calibration"), camera, width, height);
    calibration::check_plausible(calibration, path);
    return calibration;
}

bool same_geometry(const calibration::StereoCalibration& a, const calibration::StereoCalibration& b) {
    return a.left.fx == b.left.fx && a.left.cx == b.left.cx && a.left.cy == b.left.cy && a.right.cx == b.right.cx &&
           a.translation == b.translation;
}

/// Whether --keep-going leaves the frame out for its size; its calibration is of that size, too.
bool is_left_out(const SourceOptions& options, const ImageSequence::Frame& frame, ImageSize files) {
    const auto size = options.skip_damaged ? peek_image_size(frame.left) : std::nullopt;
    return size && *size != files;
}

/// Returns the calibration of frames that have one each; nothing where these differ, as one source has one geometry.
std::optional<calibration::StereoCalibration> calibration_of_frames(const SourceOptions& options,
                                                                    const ImageSequence& sequence, int width,
                                                                    int height) {
    std::optional<calibration::StereoCalibration> common;
    const ImageSize files{sequence.frames.front().right.empty() ? 2 * width : width, height};
    std::string before;
    for (const ImageSequence::Frame& frame : sequence.frames) {
        if (frame.calibration.empty() || frame.calibration == before || is_left_out(options, frame, files)) {
            continue;
        }
        before = frame.calibration;
        const calibration::StereoCalibration found =
            read_kitti(frame.calibration, sequence.kitti_camera, width, height);
        if (common && !same_geometry(*common, found)) {
            if (options.report) {
                options.report("the frames have calibrations that differ (" + common->origin + ", " +
                                   frame.calibration + "): distances are not known; name one with --calibration",
                               false);
            }
            return std::nullopt;
        }
        common = common ? common : found;
    }
    return common;
}

/// Returns which of KITTI's pairs the images are of: by their folder, else by their colour.
calibration::KittiPair kitti_pair(const ImageSequence& sequence, bool colour) {
    if (sequence.kitti_camera >= 0) {
        return sequence.kitti_camera == 0 ? calibration::KittiPair::grey : calibration::KittiPair::colour;
    }
    for (const std::filesystem::path& part : std::filesystem::path(sequence.frames.front().left).parent_path()) {
        if (part == "image_0" || part == "image_00") {
            return calibration::KittiPair::grey;
        }
        if (part == "image_2" || part == "image_02" || part == "colored_0") {
            return calibration::KittiPair::colour;
        }
    }
    return colour ? calibration::KittiPair::colour : calibration::KittiPair::grey;
}

/// Reads the calibration of cameras and inertial sensor. Where that of the sensor alone is refused, the line says how
/// the images are played all the same.
calibration::StereoCalibration read_with_sensor(const ImageSequence& sequence, int width, int height) {
    if (sequence.inertial_calibration.empty()) {
        return calibration::read_calibration(sequence.calibration, width, height);
    }
    try {
        return calibration::read_calibration(sequence.calibration + "," + sequence.inertial_calibration, width, height);
    } catch (const std::invalid_argument& error) {
        calibration::read_calibration(sequence.calibration, width, height);
        throw std::invalid_argument(std::string(error.what()) + without_inertial_sensor);
    }
}

std::optional<calibration::StereoCalibration> find_calibration(const SourceOptions& options,
                                                               const ImageSequence& sequence, bool colour, int width,
                                                               int height) {
    if (!options.calibration_path.empty()) {
        return calibration::read_calibration(options.calibration_path, width, height, kitti_pair(sequence, colour));
    }
    if (!options.calibrated) {
        return std::nullopt;
    }
    if (!sequence.calibration.empty()) {
        return sequence.kitti_camera >= 0 ? read_kitti(sequence.calibration, sequence.kitti_camera, width, height)
                                          : read_with_sensor(sequence, width, height);
    }
    if (!sequence.rectified) {
        return std::nullopt;
    }
    if (auto common = calibration_of_frames(options, sequence, width, height)) {
        return common;
    }
    calibration::StereoCalibration calibration;  // rectified, without distances
    calibration.width = width;
    calibration.height = height;
    calibration.rectified = true;
    calibration.origin = options.uri;
    return calibration;
}

class FolderSource final : public FrameSource {
public:
    explicit FolderSource(const SourceOptions& options)
        : options_(options),
          uri_(parse_image_uri(options.uri)),
          images_(asked_images(options, uri_, before_)),
          sequence_(options.first_image) {
        if (options.loans < 1) {
            throw std::invalid_argument(options.uri + ": at least 1 frame must be on loan at a time, found " +
                                        std::to_string(options.loans));
        }
        const Pair first = first_pair();
        size_ = size_of(first.left);
        if (!options.skip_damaged) {
            check_sizes(images_, size_);
        }
        if (options.report && !images_.unpaired.empty()) {
            options.report(images_.unpaired, false);
        }
        if (options.report && first.right.empty()) {
            options.report(uri_.path + ": each image is taken as both eyes side by side, " +
                               base::size_text(size_.width / 2, size_.height) + " each",
                           false);
        }
        report_deep_pixels(first);
        if (!images_.inertial_list.empty()) {
            inertial_.emplace(images_.inertial_list);
        }
        describe(first.right.empty() ? size_.width / 2 : size_.width,
                 first.left.channels() > 1 || first.right.channels() > 1);
        buffers_.resize(static_cast<std::size_t>(options.loans));
        for (cv::Mat& buffer : buffers_) {
            buffer.create(info_.height, 2 * info_.eye_width, channels() == 3 ? CV_8UC3 : CV_8UC1);
        }
        free_ = LoanPool(buffers_.size());
    }

    const SourceInfo& info() const override { return info_; }

    Next next(RawFrame& frame, Clock::time_point deadline) override {
        for (;;) {
            std::size_t buffer = 0;
            {
                std::unique_lock lock(mutex_);
                const Next state = wait_for_turn(lock, deadline);
                if (state != Next::frame) {
                    return state;
                }
                buffer = free_.take();
            }
            if (decode_or_skip(buffer)) {
                fill(frame, buffer);
                advance();
                skipped_ = 0;
                return Next::frame;
            }
            advance();
        }
    }

    void give_back(const RawFrame& frame) noexcept override {
        const std::lock_guard lock(mutex_);
        free_.give_back(static_cast<std::size_t>(frame.loan));
        changed_.notify_all();
    }

    void interrupt() noexcept override {
        const std::lock_guard lock(mutex_);
        interrupted_ = true;
        changed_.notify_all();
    }

private:
    /// A frame as it is stored; `right` is empty where `left` holds both eyes.
    struct Pair {
        cv::Mat left;
        cv::Mat right;
    };

    int channels() const { return bytes_per_pixel(info_.format); }

    /// Reads the first frame, or, where damaged ones are left out, the first whole one: all others must be like it.
    Pair first_pair() {
        for (const ImageSequence::Frame& frame : images_.frames) {
            try {
                first_name_ = frame.left;
                return read_pair(frame);
            } catch (const std::invalid_argument&) {
                if (!options_.skip_damaged || &frame == &images_.frames.back()) {
                    throw;
                }
            }
        }
        throw std::logic_error("a sequence of images has no frame");
    }

    static Pair read_pair(const ImageSequence::Frame& frame) {
        const Pair pair{decode_image(frame.left), frame.right.empty() ? cv::Mat() : decode_image(frame.right)};
        as_8_bits(pair.left, frame.left);  // refuses what cannot be used
        if (pair.right.empty()) {
            if (pair.left.cols % 2 != 0) {
                throw std::invalid_argument(frame.left + ": both eyes side by side need an even width, found " +
                                            std::to_string(pair.left.cols));
            }
            if (pair.left.cols / 2 < pair.left.rows) {
                throw std::invalid_argument(frame.left + ": found a picture of " +
                                            base::size_text(pair.left.cols, pair.left.rows) +
                                            ", which is that of one eye; expected both eyes side by side, or the "
                                            "images of each: left_%d.png,right_%d.png");
            }
            return pair;
        }
        as_8_bits(pair.right, frame.right);
        if (pair.right.size() != pair.left.size()) {
            throw std::invalid_argument(
                unequal_sizes(frame.left, size_of(pair.left), frame.right, size_of(pair.right)));
        }
        return pair;
    }

    void report_deep_pixels(const Pair& first) const {
        double largest = 0;
        for (const cv::Mat& image : {first.left, first.right}) {
            double of_image = 0;
            if (image.depth() == CV_16U) {
                cv::minMaxLoc(image.reshape(1), nullptr, &of_image);
                largest = std::max(largest, of_image);
            }
        }
        if (!options_.report || (first.left.depth() != CV_16U && first.right.depth() != CV_16U)) {
            return;
        }
        const int bits = uri_.bits != 0 ? uri_.bits : bits_of_values(images_.frames.front().left);
        constexpr int enough = 4096;
        const auto needed = std::max(9, static_cast<int>(std::bit_width(static_cast<unsigned>(largest))));
        options_.report(uri_.path + ": 16 bits per channel, frames have 8: value / " + std::to_string(1 << (bits - 8)) +
                            " is used, at most 255; the largest value of the first frame is " +
                            std::to_string(static_cast<int>(largest)) +
                            (bits != 16 ? ""
                             : largest < enough
                                 ? ", so that little is left of the images: say how many bits the values have behind "
                                   "the source, as ?bits=" +
                                       std::to_string(needed)
                                 : "; where values have fewer bits, say so behind the source, as ?bits=12"),
                        false);
    }

    /// False where a damaged frame is left out.
    bool decode_or_skip(std::size_t buffer) {
        std::string problem;
        bool of_image = false;  // not of the system, such as too little memory
        try {
            decode(buffers_[buffer]);
            take_samples();
            return true;
        } catch (const std::exception& error) {
            problem = base::failure_text(error);
            of_image = dynamic_cast<const std::invalid_argument*>(&error) != nullptr;
        }
        const bool skip = options_.skip_damaged && of_image;
        {
            const std::lock_guard lock(mutex_);
            free_.give_back(buffer);
            ended_ = !skip;
        }
        if (!skip) {
            throw std::runtime_error(problem);
        }
        ++skipped_;
        if (options_.report) {
            options_.report(problem, true);
        }
        return false;
    }

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
        info_.calibration = find_calibration(options_, images_, colour, info_.eye_width, info_.height);
        info_.description = images_.description + (inertial_ ? " with imu0, " : ", ") +
                            std::to_string(info_.eye_width) + " x " + std::to_string(info_.height) + " per eye, " +
                            (colour ? "colour" : "grey") + ", " + base::counted(count, "frame");
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
            if (free_.has_free()) {
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

    /// Returns when the next frame is due: as long after the one before as the times of the images say.
    Clock::time_point due_time() {
        if (options_.pace == Pace::fastest) {
            return Clock::time_point::min();
        }
        if (!due_) {
            const bool timed_step = images_.timed && at_ > 0;
            const std::int64_t step =
                timed_step ? images_.frames[at_].time_ns - images_.frames[at_ - 1].time_ns : untimed_period_ns;
            due_ = pacer_.due(Clock::now(), nanoseconds(step));
        }
        return *due_;
    }

    /// Takes what the inertial sensor measured since the frame before, which may be one that was left out.
    void take_samples() {
        if (!inertial_) {
            return;
        }
        if (!samples_begun_) {
            samples_begun_ = true;
            inertial_->rewind();
            if (before_.before_ns) {
                inertial_->skip_until(*before_.before_ns);
            }
        }
        inertial_->take_until(images_.frames[at_].time_ns, samples_);
        for (SensorSample& sample : samples_) {
            sample.monotonic_ns = monotonic_of(sample.camera_ns);
            sample.realtime_ns = realtime_of(sample.camera_ns);
        }
    }

    std::int64_t monotonic_of(std::int64_t time_ns) const { return time_ns - before_.start_ns; }
    /// Times that count from 0 are no date.
    std::int64_t realtime_of(std::int64_t time_ns) const { return std::max(time_ns, epoch_ns + monotonic_of(time_ns)); }

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
        const cv::Mat image = read_image(path, {uri_.bits});
        if (size_of(image) != size_) {
            throw std::invalid_argument(unequal_sizes(first_name_, size_, path, size_of(image)));
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
            frame.monotonic_ns = monotonic_of(images_.frames[at_].time_ns);
            frame.realtime_ns = realtime_of(images_.frames[at_].time_ns);
        } else {
            frame.monotonic_ns = static_cast<std::int64_t>(sequence_) * untimed_period_ns;
            frame.realtime_ns = epoch_ns + frame.monotonic_ns;
        }
        frame.flags =
            skipped_ > 0 || (sequence_ > options_.first_image && at_ == 0) ? frame_flag_discontinuity : frame_flag_none;
        frame.dropped_before = skipped_;
        const std::string_view path = images_.frames[at_].left;
        frame.name = path.substr(path.rfind('/') + 1);
        frame.loan = static_cast<int>(buffer);
        frame.sensors = samples_;
    }

    void advance() {
        ++sequence_;
        ++at_;
        if (at_ == images_.frames.size() && options_.loop) {
            at_ = 0;
            samples_begun_ = false;
        }
        due_.reset();
    }

    const SourceOptions options_;
    const ImageUri uri_;
    Before before_;
    const ImageSequence images_;
    SourceInfo info_;
    std::string first_name_;  ///< of the image that all others must be as large as
    ImageSize size_;          ///< of one file

    // Of the thread that calls next().
    std::size_t at_ = 0;
    std::uint64_t sequence_;
    std::uint32_t skipped_ = 0;  ///< damaged frames since the one before
    Pacer pacer_;
    std::optional<Clock::time_point> due_;  ///< of the next frame, once it was asked for
    bool ended_ = false;
    std::optional<InertialList> inertial_;
    bool samples_begun_ = false;         ///< in this round
    std::vector<SensorSample> samples_;  ///< of the frame that next() gave last
    std::vector<cv::Mat> buffers_;       ///< each belongs to whoever has it on loan

    std::mutex mutex_;
    std::condition_variable changed_;
    LoanPool free_{0};
    bool interrupted_ = false;
};

}  // namespace

std::unique_ptr<FrameSource> open_images(const SourceOptions& options) {
    return std::make_unique<FolderSource>(options);
}

}  // namespace disparityd::capture
