// SPDX-License-Identifier: Apache-2.0
#include "capture/recording/native_reader.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <system_error>
#include <utility>

#include "base/number_text.h"
#include "base/words.h"
#include "calibration/calibration_identity.h"
#include "capture/frame_source.h"
#include "capture/pixel_format.h"
#include "capture/recording/recording_checksum.h"
#include "capture/recording/recording_sensors.h"

namespace disparityd::capture {
namespace {

std::optional<std::uint64_t> whole_number(std::string_view text) {
    std::uint64_t value = 0;
    const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
    if (result.ec != std::errc{} || result.ptr != text.data() + text.size()) {
        return std::nullopt;
    }
    return value;
}

}  // namespace

NativeReader::NativeReader(RecordingInput input, int track) : VideoReader(std::move(input), track) {
    read_tags();
    if (jpegs_) {
        open_jpegs(read_layout());
    } else {
        open_decoder(stored_format(info_.format));
    }
    if (whole_number(required_tag(recording::tag_eye_width)) != static_cast<std::uint64_t>(info_.eye_width)) {
        throw damaged_tag(recording::tag_eye_width);
    }
}

void NativeReader::read_tags() {
    const std::string_view version = required_tag(recording::tag_format);
    jpegs_ = version == recording::version_of_jpegs;
    if (!jpegs_ && version != recording::version_of_pixels) {
        throw std::invalid_argument(input().path() + ": is a recording of format " + std::string(version) +
                                    ", this program reads the formats " + std::string(recording::version_of_pixels) +
                                    " and " + std::string(recording::version_of_jpegs));
    }
    if (const char* const kind = input().tag(recording::tag_checksums)) {
        has_checksums_ = true;
        if (kind != recording::checksums_kind) {
            throw damaged_tag(recording::tag_checksums);
        }
    }
    const auto format = pixel_format_from_name(required_tag(recording::tag_pixels));
    if (!format || (jpegs_ && *format != PixelFormat::yuyv) ||
        stream().codecpar->codec_id != (jpegs_ ? AV_CODEC_ID_MJPEG : AV_CODEC_ID_FFVHUFF)) {
        throw damaged_tag(recording::tag_pixels);
    }
    info_.format = *format;
    const auto rate = base::parse_number(required_tag(recording::tag_rate));
    if (!rate || (*rate != 0 && *rate != recording::plausible_rate(*rate))) {
        throw damaged_tag(recording::tag_rate);
    }
    info_.rate = *rate;
    // Our writer has FFmpeg leave out its version. Another program that cuts or joins recordings names itself and
    // copies our tags as they are: the number of frames is then that of the original recording.
    const char* const encoder = input().tag("encoder");
    edited_ = encoder != nullptr && std::string_view(encoder) != "Lavf";
    // The tag is zero until the file is closed.
    const auto frame_count = whole_number(required_tag(recording::tag_frames));
    if (!edited_ && frame_count && *frame_count > 0) {
        info_.frame_count = frame_count;
    }
    if (const char* source = input().tag(recording::tag_source)) {
        info_.content = std::string("recording of ") + source;
    }
    info_.synthetic = input().tag(recording::tag_synthetic) != nullptr;
    read_time_offset();
    read_calibration();
}

void NativeReader::read_time_offset() {
    if (const char* const text = input().tag(recording::tag_time_offset)) {
        const auto offset_us = base::parse_number(text);
        if (!offset_us || std::abs(*offset_us) > recording::max_time_offset_us ||
            *offset_us != std::trunc(*offset_us)) {
            throw damaged_tag(recording::tag_time_offset);
        }
        info_.time_offset_us = static_cast<int>(*offset_us);
    }
}

EyeLayout NativeReader::read_layout() const {
    const std::string_view layout = required_tag(recording::tag_layout);
    const std::string_view first = required_tag(recording::tag_first);
    EyeLayout eyes;
    eyes.top_bottom = layout == "top-bottom";
    eyes.right_first = first == "right";
    if (!eyes.top_bottom && layout != "side-by-side") {
        throw damaged_tag(recording::tag_layout);
    }
    if (!eyes.right_first && first != "left") {
        throw damaged_tag(recording::tag_first);
    }
    eyes.eye_width = stream().codecpar->width / (eyes.top_bottom ? 1 : 2);
    eyes.eye_height = stream().codecpar->height / (eyes.top_bottom ? 2 : 1);
    return eyes;
}

void NativeReader::read_calibration() {
    const char* const calibration = input().tag(recording::tag_calibration);
    if (calibration == nullptr) {
        if (input().tag(recording::tag_calibration_id) != nullptr) {
            required_tag(recording::tag_calibration);
        }
        return;
    }
    if (required_tag(recording::tag_calibration_id) != calibration::calibration_identity(calibration)) {
        throw damaged_tag(recording::tag_calibration_id);
    }
    info_.calibration_text = calibration;
}

std::string_view NativeReader::required_tag(const char* key) const {
    const char* text = input().tag(key);
    if (text == nullptr) {
        throw std::invalid_argument(input().path() + ": the recording is damaged: its tag " + key + " is missing");
    }
    return text;
}

std::invalid_argument NativeReader::damaged_tag(const char* key) const {
    return std::invalid_argument(input().path() + ": the recording is damaged: its tag " + key + " says \"" +
                                 input().tag(key) + "\"");
}

bool NativeReader::accept(const AVPacket& packet) {
    if ((packet.flags & AV_PKT_FLAG_CORRUPT) != 0) {
        fail_truncated("the next one is incomplete");
    }
    std::optional<Stored> stored = stored_of(packet);
    if (!stored) {
        leave_out("its times are missing or not those that were recorded");
        return false;
    }
    if (jpegs_ && stored->checksum) {
        const auto size = static_cast<std::size_t>(packet.size);
        if (recording::checksum(std::span<const std::uint8_t>(packet.data, size)) != *stored->checksum) {
            leave_out("its JPEG is not the one that was recorded", stored->facts);
            return false;
        }
        stored->checksum.reset();
    }
    stored_.push_back(std::move(*stored));
    return true;
}

void NativeReader::refused(const std::string& why) {
    if (stored_.empty()) {
        leave_out(why);
        return;
    }
    leave_out(why, stored_.back().facts);
    stored_.pop_back();
}

void NativeReader::leave_out(const std::string& why) {
    if (left_out_++ == 0) {
        left_out_why_ = why;
    }
    ++left_out_before_;
}

void NativeReader::leave_out(const std::string& why, const recording::FrameFacts& facts) {
    leave_out(why);
    for (const SensorSample& sample : facts.sensors) {
        samples_left_out_ += 1 + sample.lost_before;
    }
}

/// Returns nothing where the facts are missing or damaged.
std::optional<NativeReader::Stored> NativeReader::stored_of(const AVPacket& packet) const {
    std::span<const std::uint8_t> bytes;
    for (int i = 0; i < packet.side_data_elems; ++i) {
        const AVPacketSideData& side = packet.side_data[i];
        if (side.type == AV_PKT_DATA_MATROSKA_BLOCKADDITIONAL) {
            bytes = {side.data, static_cast<std::size_t>(side.size)};
        }
    }
    const auto behind = bytes.subspan(std::min(recording::facts_size, bytes.size()));
    auto facts = recording::get_facts(bytes);
    auto sensors = recording::get_sensors(behind);
    const auto sensors_size = recording::stored_sensors_size(behind);
    if (!facts || !sensors || !sensors_size) {
        return std::nullopt;
    }
    facts->sensors = std::move(*sensors);
    const std::size_t end = recording::facts_size + *sensors_size + recording::checksums_size;
    if (bytes.size() < end) {
        return has_checksums_ ? std::nullopt : std::optional<Stored>({std::move(*facts), std::nullopt});
    }
    const auto checksums =
        recording::get_checksums(bytes.subspan(recording::block_add_id_size, end - recording::block_add_id_size));
    if (!checksums || !checksums->addition_is_whole) {
        return std::nullopt;
    }
    return Stored{std::move(*facts), checksums->picture};
}

recording::FrameFacts NativeReader::take_facts(const AVFrame& frame) {
    if (stored_.empty()) {  // the decoder made more frames than it was given packets
        fail_changed_picture(frame);
    }
    recording::FrameFacts facts = std::move(stored_.front().facts);
    checksum_ = stored_.front().checksum;
    stored_.pop_front();
    return facts;
}

bool NativeReader::keep(recording::FrameFacts& facts, const RawImage& image) {
    if (checksum_ && *checksum_ != recording::checksum(image)) {
        leave_out("its pixels are not those that were recorded", facts);
        return false;
    }
    if (!facts.sensors.empty()) {
        facts.sensors.front().lost_before += std::exchange(samples_left_out_, 0);
    }
    count_gap(facts);
    return true;
}

/// Counts frames that a damaged file lacks inside as lost before the next one: the numbers count every frame, recorded
/// or lost. Numbers of another program's cuts mean nothing, nor those after a gap of the source.
void NativeReader::count_gap(recording::FrameFacts& facts) {
    constexpr std::uint64_t most_missing = 1'000'000;  // with more, the number itself is damaged
    const bool follows = next_sequence_ && !edited_ && (facts.flags & frame_flag_discontinuity) == 0;
    if (follows && facts.sequence > *next_sequence_ + facts.dropped_before) {
        const std::uint64_t missing = facts.sequence - *next_sequence_ - facts.dropped_before;
        facts.dropped_before += missing <= most_missing ? static_cast<std::uint32_t>(missing) : 0;
    } else if (!follows) {
        facts.dropped_before += left_out_before_;
    }
    left_out_before_ = 0;
    next_sequence_ = facts.sequence + 1;
}

void NativeReader::check_end() const {
    check_file_size();
    if (!edited_ && !input().says_its_size()) {
        fail_truncated("the recorder was stopped before it closed the file, or wrote into a pipe");
    }
    if (left_out_ > 0) {
        throw std::runtime_error(input().path() + ": damaged: " + frames_read() + " could be read, " +
                                 base::counted(left_out_, "frame") + (left_out_ == 1 ? " was" : " were") +
                                 " left out, the first because " + left_out_why_);
    }
    check_end_error();
    if (info_.frame_count && frames() < *info_.frame_count) {
        fail_truncated("frames are missing inside the file");
    }
}

}  // namespace disparityd::capture
