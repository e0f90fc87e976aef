// SPDX-License-Identifier: Apache-2.0
#include "capture/bag/bag_reader.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "base/message_text.h"
#include "capture/bag/bag_survey.h"
#include "capture/frame_source.h"

namespace disparityd::capture {
namespace {

/// What a bag without a list of its topics is read of to find them, and what any is to find its calibration.
constexpr std::uint64_t survey_bytes = std::uint64_t{256} << 20U;

constexpr std::int64_t epoch_ns = 946'684'800'000'000'000;  // 2000-01-01, UTC

SensorVector vector_of(const formats::RosMessage& message, const std::string& field) {
    return {static_cast<float>(message.number(field + ".x")), static_cast<float>(message.number(field + ".y")),
            static_cast<float>(message.number(field + ".z"))};
}

PixelFormat format_of(const cv::Mat& left, const cv::Mat& right) {
    const auto all = [&](int type) { return left.type() == type && (right.empty() || right.type() == type); };
    return all(CV_8UC1) ? PixelFormat::grey8 : all(CV_8UC2) ? PixelFormat::yuyv : PixelFormat::bgr24;
}

/// Copies an image to where it belongs in a frame; grey becomes coloured where the other eye is.
void put_image(const cv::Mat& image, cv::Mat into, const std::string& path) {
    if (image.type() == into.type()) {
        image.copyTo(into);
    } else if (image.type() == CV_8UC1 && into.type() == CV_8UC3) {
        cv::cvtColor(image, into, cv::COLOR_GRAY2BGR);
    } else if (image.type() == CV_8UC3 && into.type() == CV_8UC1) {
        cv::cvtColor(image, into, cv::COLOR_BGR2GRAY);
    } else if (image.type() == CV_8UC2 && into.type() == CV_8UC3) {
        cv::cvtColor(image, into, cv::COLOR_YUV2BGR_YUYV);
    } else {
        throw std::runtime_error(path +
                                 ": the encoding of the images changes to one that does not fit the first frame");
    }
}

}  // namespace

BagReader::BagReader(const BagUri& uri, bool calibrated, std::optional<ChosenTopics> known)
    : uri_(uri), pairs_(uri.within_ns) {
    if (known) {
        topics_ = *std::move(known);
    } else {
        survey(calibrated);
    }
    bag_.emplace(uri_.path);
    constexpr std::size_t for_the_rate = 2;
    while (first_.size() < for_the_rate) {
        auto frame = next_frame();
        if (!frame) {
            break;
        }
        first_.push_back(*std::move(frame));
    }
    if (first_.empty()) {
        if (failure_) {
            std::rethrow_exception(failure_);
        }
        throw std::invalid_argument(uri_.path + ": no images of " + base::printable(topics_.left) + " and " +
                                    base::printable(topics_.right) + " are at most " +
                                    std::to_string(uri_.within_ns / 1'000'000) +
                                    " ms apart; name the topics of one camera, or another limit as within_ms=20");
    }
    describe(calibrated);
}

void BagReader::survey(bool calibrated) {
    BagMessages bag(uri_.path);
    if (!bag.has_all_topics()) {
        try {
            BagMessages::Message message;
            while (bag.position() < survey_bytes && bag.next(message)) {
            }
        } catch (const std::runtime_error&) {
            // What is whole may do: reading it as frames says what is wrong.
        }
    }
    topics_ = choose_topics(uri_, bag.topics());
    info_.notices = topics_.notices;
    if (calibrated && (topics_.left_info.empty() || topics_.right_info.empty()) && !topics_.right.empty()) {
        info_.notices.push_back(uri_.path +
                                ": has no sensor_msgs/msg/CameraInfo beside the images: distances are not "
                                "known; name a calibration with --calibration");
    }
}

void BagReader::read_calibration() {
    const BagSurvey bag = survey_bag(uri_.path, topics_, survey_bytes);
    auto found = bag.left && bag.right
                     ? calibration_of(*bag.left, *bag.right, info_.eye_width, info_.height, topics_.rectified)
                     : std::nullopt;
    if (found) {
        if (bag.imu_to_left) {
            // /tf_static leads to the camera that took the raw images; its R turns that to the rectified one.
            calibration::Pose turn;
            if (topics_.rectified) {
                std::copy(bag.left->rotation.begin(), bag.left->rotation.end(), turn.rotation.begin());
            }
            found->inertial.to_left_camera = calibration::chained(*bag.imu_to_left, turn);
        }
        try {
            calibration::check_inertial(found->inertial, uri_.path);
        } catch (const std::invalid_argument&) {
            found->inertial.to_left_camera.reset();  // distances are known without it
            info_.notices.push_back(uri_.path + ": the inertial sensor has no place that can be: see its /tf_static" +
                                    (topics_.rectified ? ", and the R of the left CameraInfo" : ""));
        }
        info_.calibration_text = calibration::to_text(*found);
    } else {
        info_.notices.push_back(uri_.path +
                                ": the CameraInfo of both eyes has no calibration: distances are not known; "
                                "name one with --calibration");
    }
}

void BagReader::describe(bool calibrated) {
    const Pair& eyes = first_.front().eyes;
    const cv::Mat& left = eyes.left.pixels;
    const bool side_by_side = topics_.right.empty();
    info_.content = "ROS bag, " + base::printable(topics_.left) +
                    (side_by_side ? " side by side" : " and " + base::printable(topics_.right));
    info_.format = format_of(left, eyes.right.pixels);
    info_.eye_width = side_by_side ? left.cols / 2 : left.cols;
    info_.height = left.rows;
    const int even = info_.format == PixelFormat::yuyv ? 2 : 1;
    if (info_.eye_width % even != 0 || (side_by_side && (left.cols % 2 != 0 || info_.eye_width < info_.height))) {
        throw std::invalid_argument(uri_.path + ": found images of " + base::size_text(left.cols, left.rows) +
                                    " on the one topic with images, which do not hold both eyes side by side");
    }
    check_size(eyes.right.pixels, info_.eye_width);
    start_ns_ = eyes.left.stamp_ns;
    if (first_.size() > 1) {
        const std::int64_t step = first_.back().eyes.left.stamp_ns - start_ns_;
        info_.rate = step > 0 ? recording::plausible_rate(1e9 / static_cast<double>(step)) : 0;
    }
    if (calibrated && !topics_.left_info.empty() && !topics_.right_info.empty()) {
        read_calibration();
    }
}

std::size_t BagReader::frame_bytes() const {
    return 2 * static_cast<std::size_t>(info_.eye_width) * static_cast<std::size_t>(info_.height) *
           static_cast<std::size_t>(bytes_per_pixel(info_.format));
}

bool BagReader::read(recording::FrameFacts& facts, std::uint8_t* pixels) {
    std::optional<Frame> frame;
    if (first_.empty()) {
        frame = next_frame();
    } else {
        frame = std::move(first_.front());
        first_.pop_front();
    }
    if (!frame) {
        if (failure_) {
            std::rethrow_exception(std::exchange(failure_, nullptr));
        }
        return false;
    }
    put_pixels(*frame, pixels);
    facts = recording::FrameFacts();
    sequence_ += frame->lost_before;
    facts.sequence = sequence_++;
    facts.dropped_before = frame->lost_before;
    facts.flags = frame->lost_before > 0 ? frame_flag_discontinuity : frame_flag_none;
    const std::int64_t stamp_ns = frame->eyes.left.stamp_ns;
    facts.monotonic_ns = stamp_ns - start_ns_;
    // Simulated time is no date.
    facts.realtime_ns = std::max(stamp_ns, epoch_ns + facts.monotonic_ns);
    facts.sensors = std::move(frame->sensors);
    for (SensorSample& sample : facts.sensors) {
        sample.monotonic_ns = sample.camera_ns - start_ns_;
        sample.realtime_ns = std::max(sample.camera_ns, epoch_ns + sample.monotonic_ns);
    }
    return true;
}

std::optional<BagReader::Frame> BagReader::next_frame() {
    auto pair = next_pair();
    if (!pair) {
        return std::nullopt;
    }
    Frame frame{*std::move(pair), pairs_.take_unpaired(), std::exchange(sensors_, {})};
    if (!frame.sensors.empty()) {
        frame.sensors.front().lost_before = std::exchange(lost_samples_, 0);
    }
    return frame;
}

std::optional<BagReader::Pair> BagReader::next_pair() {
    for (;;) {
        if (both_) {
            return Pair{*std::exchange(both_, std::nullopt), BagImage()};
        }
        if (auto pair = pairs_.take(ended_)) {
            return pair;
        }
        if (ended_) {
            return std::nullopt;
        }
        try {
            take_message();
        } catch (const std::runtime_error&) {
            failure_ = std::current_exception();
            ended_ = true;
        }
    }
}

void BagReader::take_message() {
    BagMessages::Message message;
    if (!bag_->next(message)) {
        ended_ = true;
        return;
    }
    const bool left = message.topic == topics_.left;
    const bool right = !topics_.right.empty() && message.topic == topics_.right;
    const bool imu = !topics_.imu.empty() && message.topic == topics_.imu;
    if (!left && !right && !imu) {
        return;
    }
    const formats::RosMessage fields = bag_->decode(message);
    try {
        const std::int64_t stamp_ns = stamp_of(fields, message.log_ns);
        if (imu) {
            take_sample(fields, stamp_ns);
        } else if (topics_.right.empty()) {
            both_ = BagImage{stamp_ns, pixels_of(fields, uri_.bits)};
        } else {
            pairs_.add(left ? Eye::left : Eye::right, {stamp_ns, pixels_of(fields, uri_.bits)});
        }
    } catch (const std::runtime_error& error) {
        bag_->fail(message, error.what());
    }
}

void BagReader::take_sample(const formats::RosMessage& message, std::int64_t stamp_ns) {
    SensorSample sample;
    sample.camera_ns = stamp_ns;
    sample.flags = sensor_flag_inertial;
    sample.angular_velocity = vector_of(message, "angular_velocity");
    sample.acceleration = vector_of(message, "linear_acceleration");
    if (sensors_.size() == RawFrame::most_samples) {
        sensors_.erase(sensors_.begin());
        ++lost_samples_;
    }
    sensors_.push_back(sample);
}

void BagReader::check_size(const cv::Mat& pixels, int width) const {
    if (!pixels.empty() && (pixels.cols != width || pixels.rows != info_.height)) {
        throw std::runtime_error(uri_.path + ": images of unequal sizes: the first is " +
                                 base::size_text(width, info_.height) + ", another one " +
                                 base::size_text(pixels.cols, pixels.rows) + "; all must be alike");
    }
}

void BagReader::put_pixels(const Frame& frame, std::uint8_t* pixels) const {
    const int type = CV_8UC(bytes_per_pixel(info_.format));
    cv::Mat both(info_.height, 2 * info_.eye_width, type, pixels);
    const cv::Mat& left = frame.eyes.left.pixels;
    if (topics_.right.empty()) {
        check_size(left, 2 * info_.eye_width);
        put_image(left, both, uri_.path);
        return;
    }
    const cv::Mat& right = frame.eyes.right.pixels;
    check_size(left, info_.eye_width);
    check_size(right, info_.eye_width);
    put_image(left, both.colRange(0, info_.eye_width), uri_.path);
    put_image(right, both.colRange(info_.eye_width, 2 * info_.eye_width), uri_.path);
}

}  // namespace disparityd::capture
