// SPDX-License-Identifier: Apache-2.0
#include "capture/svo/svo_reader.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "base/message_text.h"
#include "base/words.h"
#include "calibration/calibration_lookup.h"
#include "capture/pixel_format.h"

namespace disparityd::capture {
namespace {

constexpr std::string_view header_topic = "svo_header";
constexpr std::string_view video_name = "side_by_side";
constexpr std::string_view sensors_name = "sensors";

/// What is tried to find the first frame in.
constexpr std::int64_t most_tried = 120;

/// Pictures that a decoder may keep before it gives the first: more than H.264 and H.265 allow.
constexpr std::size_t most_sent = 64;

constexpr std::int64_t epoch_ns = 946'684'800'000'000'000;  // 2000-01-01, UTC

/// Whether a topic is of those that these files have. What is in the others than header, video and sensors is not
/// needed: the times of all messages, and the sensors once more at the times of the frames.
bool is_known(std::string_view topic) {
    return topic == header_topic || topic == "svo_footer" || serial_of_topic(topic, video_name) ||
           serial_of_topic(topic, sensors_name) || serial_of_topic(topic, "sensors_integrated") ||
           serial_of_topic(topic, "integrated_sensors");
}

std::int64_t clamped(std::uint64_t ns) {
    constexpr std::uint64_t most = 4'000'000'000'000'000'000;  // the year 2096; differences of times fit
    return static_cast<std::int64_t>(std::min(ns, most));
}

/// Puts the samples that came before in front of the others, and lets go of the oldest where there are too many for a
/// frame.
void put_in_front(std::vector<SensorSample> earlier, std::vector<SensorSample>& samples) {
    earlier.insert(earlier.end(), samples.begin(), samples.end());
    if (earlier.size() > RawFrame::most_samples) {
        const std::size_t surplus = earlier.size() - RawFrame::most_samples;
        std::uint32_t lost = static_cast<std::uint32_t>(surplus);
        for (std::size_t i = 0; i <= surplus; ++i) {
            lost += earlier[i].lost_before;
        }
        earlier.erase(earlier.begin(), earlier.begin() + static_cast<std::ptrdiff_t>(surplus));
        earlier.front().lost_before = lost;
    }
    samples = std::move(earlier);
}

std::string name_of(SvoPayload payload, std::optional<AnnexBCodec> codec) {
    switch (payload) {
        case SvoPayload::annex_b: return codec == AnnexBCodec::h265 ? "H.265" : "H.264";
        case SvoPayload::png: return "PNG";
        case SvoPayload::zstd: return "zstd";
        case SvoPayload::jpeg_strips: return "JPEG";
        case SvoPayload::unknown: break;
    }
    return "unknown";
}

}  // namespace

SvoReader::SvoReader(const SourceOptions& options) : options_(options), file_(options.uri) {
    constexpr std::size_t for_the_rate = 2;
    read_until(for_the_rate);
    if (ready_.empty()) {
        if (failure_) {
            std::rethrow_exception(failure_);
        }
        refuse();
    }
    describe();
}

/// Reads messages until so many frames are ready, or the file ends.
void SvoReader::read_until(std::size_t frames) {
    while (ready_.size() < frames && !ended_) {
        try {
            take_message();
        } catch (const std::runtime_error&) {
            failure_ = std::current_exception();
            ended_ = true;
        }
        if (ended_ && video_) {
            video_->end();
            receive_pictures();
        }
        if (last_number_ < 0 && messages_ >= most_tried) {
            refuse();
        }
    }
}

void SvoReader::take_message() {
    formats::McapMessage message;
    if (!file_.next(message)) {
        ended_ = true;
        return;
    }
    const std::string& topic = file_.definitions().channels().at(message.channel).topic;
    if (topic == header_topic) {
        take_header(message.data);
    } else if (const auto serial = serial_of_topic(topic, sensors_name)) {
        serial_ = serial_.empty() ? *serial : serial_;
        if (*serial == serial_) {
            take_sample(message);
        }
    } else if (const auto of_video = serial_of_topic(topic, video_name)) {
        if (camera_.empty()) {
            camera_ = topic;
            if (std::exchange(serial_, *of_video) != *of_video) {
                sensors_.clear();  // of another camera
                lost_samples_ = 0;
            }
        }
        if (topic == camera_) {
            take_video(message);
        }
    }
}

void SvoReader::take_header(std::span<const std::uint8_t> data) {
    try {
        header_ = read_svo_header(data);
    } catch (const std::runtime_error& error) {
        if (!std::exchange(header_told_, true)) {
            info_.notices.push_back(options_.uri + ": the header is not understood: " + error.what());
        }
    }
    if (header_.encrypted) {
        throw std::invalid_argument(options_.uri +
                                    ": is an encrypted recording of the ZED SDK: decrypt or export it with that SDK");
    }
}

void SvoReader::take_video(const formats::McapMessage& message) {
    ++messages_;
    try {
        const SvoVideoMessage video = read_svo_video(message.data);
        Message sent;
        sent.stamp_ns = stamp_of(video, message.log_ns);
        sent.index = video.footer ? video.footer->index : -1;
        sent.sensors = std::exchange(sensors_, {});
        if (sent_.size() == most_sent) {
            auto oldest = sent_.begin();
            put_in_front(std::move(oldest->second.sensors), std::next(oldest)->second.sensors);
            sent_.erase(oldest);
        }
        sent_.emplace(messages_ - 1, std::move(sent));
        take_payload(video.payload, video.footer && video.footer->size ? video.footer->size : header_.size);
    } catch (const std::runtime_error& error) {
        leave_out(error.what());
    }
}

/// Returns when a frame was captured, by its footer; by the container where the first footer has no time.
std::int64_t SvoReader::stamp_of(const SvoVideoMessage& video, std::uint64_t log_ns) {
    const auto in_footer = video.footer ? unix_ns(video.footer->stamp) : std::nullopt;
    by_log_ = by_log_.value_or(!in_footer);
    if (*by_log_) {
        last_stamp_ns_ = unix_ns(log_ns).value_or(clamped(log_ns));
    } else if (in_footer) {
        last_stamp_ns_ = *in_footer;
    } else {
        constexpr double usual_rate = 30;
        last_stamp_ns_ += std::llround(1e9 / (header_.rate > 0 ? header_.rate : usual_rate));
    }
    return last_stamp_ns_;
}

void SvoReader::take_payload(std::span<const std::uint8_t> payload, std::optional<SvoSize> size) {
    const SvoPayload kind = payload_kind(payload);
    if (kind == SvoPayload::unknown) {
        throw std::runtime_error("its payload begins with the bytes " + first_bytes(payload) +
                                 ", allowed are H.264 and H.265 (00 00 00 01), PNG (89 50 4e 47), zstd (28 b5 2f fd) "
                                 "and JPEGs behind their sizes; it may be encrypted");
    }
    payload_ = payload_.value_or(kind);
    if (kind == SvoPayload::annex_b) {
        take_units(payload);
    } else {
        try {
            add_frame(messages_ - 1, unpack_svo_picture(kind, payload, size));
        } catch (const std::invalid_argument& error) {  // of an image
            throw std::runtime_error(error.what());
        }
    }
}

/// Units that build on what was left out would give wrong pictures: the video goes on where it starts anew.
void SvoReader::take_units(std::span<const std::uint8_t> payload) {
    const auto starts = annex_b_start(payload);
    if (start_needed_ && !starts) {
        throw std::runtime_error("it builds on pictures that are not there");
    }
    if (starts && starts != codec_) {
        codec_ = starts;
        video_.emplace(*codec_, options_.uri);
    }
    start_needed_ = false;
    video_->send(payload, messages_ - 1);
    receive_pictures();
}

void SvoReader::receive_pictures() {
    try {
        while (auto decoded = video_->receive()) {
            add_frame(decoded->number, std::move(decoded->picture));
        }
    } catch (const std::runtime_error& error) {
        leave_out(error.what());
    }
}

/// Puts a picture together with what came with it, and with the samples of the messages before it that gave none.
void SvoReader::add_frame(std::int64_t number, SvoPicture picture) {
    const auto found = sent_.find(number);
    if (found == sent_.end()) {
        throw std::runtime_error("its picture is older than one before it");
    }
    Frame frame{std::move(found->second), std::move(picture), static_cast<std::uint32_t>(number - last_number_ - 1)};
    for (auto earlier = found; earlier != sent_.begin();) {
        --earlier;
        put_in_front(std::move(earlier->second.sensors), frame.message.sensors);
    }
    sent_.erase(sent_.begin(), std::next(found));
    left_out_ += frame.left_out;
    last_number_ = number;
    ready_.push_back(std::move(frame));
}

void SvoReader::leave_out(const std::string& why) {
    left_out_why_ = left_out_why_.empty() ? why : left_out_why_;
    start_needed_ = true;
}

void SvoReader::take_sample(const formats::McapMessage& message) {
    try {
        SensorSample sample = read_svo_sensors(message.data);
        sample.monotonic_ns = unix_ns(message.log_ns).value_or(clamped(message.log_ns));  // set_facts() chooses
        sample.lost_before = std::exchange(lost_samples_, 0);
        put_in_front(std::exchange(sensors_, {sample}), sensors_);
    } catch (const std::runtime_error& error) {
        ++lost_samples_;
        if (sensors_left_out_++ == 0) {
            sensors_why_ = error.what();
            info_.notices.push_back(options_.uri +
                                    ": a message of the sensors is not understood and left out: " + error.what());
        }
    }
}

/// Throws for a file whose first messages give no frame.
void SvoReader::refuse() const {
    if (messages_ == 0) {
        throw std::invalid_argument(options_.uri +
                                    ": holds no video of a ZED camera (a topic such as Camera_SN123/side_by_side); "
                                    "another MCAP file is read as a ROS 2 bag where its name ends in .mcap");
    }
    throw std::invalid_argument(options_.uri + ": no frame can be read of its first " +
                                base::counted(static_cast<std::uint64_t>(messages_), "video message") +
                                ", the first because " + left_out_why_ +
                                "; export it with the ZED SDK that recorded it");
}

void SvoReader::describe() {
    const Frame& first = ready_.front();
    info_.format = first.picture.format;
    info_.eye_width = first.picture.width / 2;
    info_.height = first.picture.height;
    info_.content = "recording of the ZED SDK " + base::printable(header_.sdk_version) +
                    (header_.sdk_version.empty() ? "" : " ") + "(SVO2, experimental), " + name_of(*payload_, codec_);
    start_ns_ = first.message.stamp_ns;
    info_.rate = header_.rate;
    if (const std::int64_t step = ready_.back().message.stamp_ns - start_ns_; info_.rate <= 0 && step > 0) {
        info_.rate = recording::plausible_rate(1e9 / static_cast<double>(step));
    }
    info_.notices.push_back(
        options_.uri + ": reading SVO2 is experimental: it was made from public descriptions, without a real file");
    if (*payload_ == SvoPayload::annex_b || *payload_ == SvoPayload::jpeg_strips) {
        info_.notices.push_back(options_.uri + ": " + name_of(*payload_, codec_) + " is lossy" +
                                (*payload_ == SvoPayload::annex_b ? " unless it was recorded as lossless" : "") +
                                ": that costs accuracy of distances");
    }
    describe_topics();
    if (options_.calibrated && options_.calibration_path.empty()) {
        find_calibration();
    }
}

void SvoReader::describe_topics() {
    std::string others = base::printable(camera_);
    std::string unknown;
    bool several = false;
    for (const auto& [id, channel] : file_.definitions().channels()) {
        const auto count = file_.message_count(id);
        if (channel.topic == camera_) {
            info_.frame_count = count;
        } else if (serial_of_topic(channel.topic, video_name)) {
            others += ", ";
            others += base::printable(channel.topic);
            several = true;
        } else if (serial_of_topic(channel.topic, sensors_name).value_or(serial_) != serial_ ||
                   !is_known(channel.topic)) {
            unknown += (unknown.empty() ? "" : ", ") + base::printable(channel.topic) +
                       (count ? " (" + base::counted(*count, "message") + ")" : "");
        }
    }
    if (several) {
        throw std::invalid_argument(options_.uri + ": holds the video of several cameras, expected one: " + others);
    }
    if (!unknown.empty()) {
        info_.notices.push_back(options_.uri + ": these topics are not known, or of another camera, and not read: " +
                                base::printable_line(unknown));
    }
}

void SvoReader::find_calibration() {
    const std::string of_topic(serial_of_topic(camera_, video_name).value_or(""));
    if (!header_.serial.empty() && header_.serial != of_topic) {
        info_.notices.push_back(options_.uri + ": the header has the serial number " + header_.serial +
                                ", the topic of the video has " + of_topic + ", which is taken");
    }
    info_.serial = of_topic;
    const auto found =
        calibration::find_camera_calibration(of_topic, options_.calibration_folders, info_.eye_width, info_.height);
    if (found) {
        info_.calibration_text = calibration::to_text(*found);
        info_.calibration_origin = found->origin;
        return;
    }
    std::string folders;
    for (const std::string& folder : options_.calibration_folders) {
        folders += (folders.empty() ? "" : " or ") + folder;
    }
    info_.notices.push_back(options_.uri + ": there is no calibration for the camera with serial number " + of_topic +
                            ": put SN" + of_topic + ".conf into " +
                            (folders.empty() ? "a folder of calibrations" : folders) +
                            ", or name a file with --calibration or [source] calibration");
}

std::size_t SvoReader::frame_bytes() const {
    return 2 * static_cast<std::size_t>(info_.eye_width) * static_cast<std::size_t>(info_.height) *
           static_cast<std::size_t>(bytes_per_pixel(info_.format));
}

bool SvoReader::read(recording::FrameFacts& facts, std::uint8_t* pixels) {
    read_until(1);
    if (ready_.empty()) {
        check_end();
        return false;
    }
    Frame frame = std::move(ready_.front());
    ready_.pop_front();
    const SvoPicture& picture = frame.picture;
    if (picture.format != info_.format || picture.width != 2 * info_.eye_width || picture.height != info_.height) {
        ended_ = true;
        ready_.clear();
        throw std::runtime_error(options_.uri + ": the picture changes after " + base::counted(frames_, "frame") +
                                 ": found " + base::size_text(picture.width, picture.height) + " " +
                                 std::string(to_string(picture.format)) + ", it began with " +
                                 base::size_text(2 * info_.eye_width, info_.height) + " " +
                                 std::string(to_string(info_.format)));
    }
    std::memcpy(pixels, picture.pixels.data, frame_bytes());
    set_facts(frame, facts);
    ++frames_;
    return true;
}

void SvoReader::set_facts(Frame& frame, recording::FrameFacts& facts) {
    facts = recording::FrameFacts();
    std::uint32_t lost = frame.left_out;
    const std::int32_t index = frame.message.index;
    if (last_index_ && index > *last_index_) {
        lost = std::max(lost, static_cast<std::uint32_t>(std::int64_t{index} - *last_index_ - 1));
    }
    last_index_ = index >= 0 ? std::optional(index) : std::nullopt;
    sequence_ = frames_ == 0 && index >= 0 ? static_cast<std::uint64_t>(index) : sequence_ + lost;
    facts.sequence = sequence_++;
    facts.dropped_before = lost;
    facts.flags = (lost > 0 ? frame_flag_discontinuity : frame_flag_none) |
                  (frame.picture.damaged ? frame_flag_corrupt : frame_flag_none);
    const auto set_times = [this](auto& of, std::int64_t stamp_ns) {
        of.monotonic_ns = stamp_ns - start_ns_;
        of.realtime_ns = std::max(stamp_ns, epoch_ns + of.monotonic_ns);  // time since a start is no date
    };
    set_times(facts, frame.message.stamp_ns);
    facts.sensors = std::move(frame.message.sensors);
    for (SensorSample& sample : facts.sensors) {
        set_times(sample, *by_log_ ? sample.monotonic_ns : sample.camera_ns);
    }
}

void SvoReader::check_end() {
    if (failure_) {
        std::rethrow_exception(std::exchange(failure_, nullptr));
    }
    left_out_ += static_cast<std::uint64_t>(messages_ - 1 - last_number_);
    last_number_ = messages_ - 1;
    std::string problem;
    if (const std::uint64_t left_out = std::exchange(left_out_, 0); left_out > 0) {
        problem = std::to_string(left_out) + " of " +
                  base::counted(static_cast<std::uint64_t>(messages_), "video message") + " gave no frame" +
                  (left_out_why_.empty() ? "" : ", the first because " + left_out_why_);
    }
    if (const std::uint64_t left_out = std::exchange(sensors_left_out_, 0); left_out > 0) {
        problem += (problem.empty() ? "" : "; ") + base::counted(left_out, "message") +
                   " of the sensors gave no sample, the first because " + sensors_why_;
    }
    if (!problem.empty()) {
        throw std::runtime_error(options_.uri + ": " + problem);
    }
}

}  // namespace disparityd::capture
