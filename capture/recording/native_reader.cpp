// SPDX-License-Identifier: Apache-2.0
#include "capture/recording/native_reader.h"

#include <charconv>
#include <cstdint>
#include <system_error>
#include <utility>

#include "base/number_text.h"
#include "calibration/calibration_identity.h"
#include "capture/frame_source.h"
#include "capture/pixel_format.h"
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

NativeReader::NativeReader(RecordingInput input) : VideoReader(std::move(input)) {
    info_.is_native = true;
    read_tags();
    open_decoder(stored_format(info_.format));
}

void NativeReader::read_tags() {
    const std::string_view version = required_tag(recording::tag_format);
    if (version != recording::format_version) {
        throw std::invalid_argument(input().path() + ": is a recording of format " + std::string(version) +
                                    ", this program reads format " + std::string(recording::format_version));
    }
    const auto format = pixel_format_from_name(required_tag(recording::tag_pixels));
    if (!format || stream().codecpar->codec_id != AV_CODEC_ID_FFVHUFF) {
        throw damaged_tag(recording::tag_pixels);
    }
    info_.format = *format;
    if (whole_number(required_tag(recording::tag_eye_width)) != static_cast<std::uint64_t>(info_.eye_width)) {
        throw damaged_tag(recording::tag_eye_width);
    }
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
        info_.source = source;
    }
    info_.synthetic = input().tag(recording::tag_synthetic) != nullptr;
    read_calibration();
}

void NativeReader::read_calibration() {
    const char* const calibration = input().tag(recording::tag_calibration);
    if (calibration == nullptr) {
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
    std::optional<recording::FrameFacts> facts;
    for (int i = 0; i < packet.side_data_elems; ++i) {
        const AVPacketSideData& side = packet.side_data[i];
        if (side.type == AV_PKT_DATA_MATROSKA_BLOCKADDITIONAL) {
            facts = facts_of({side.data, static_cast<std::size_t>(side.size)});
        }
    }
    if (!facts) {
        fail_truncated("the next one has no times");
    }
    facts_.push_back(std::move(*facts));
    return true;
}

void NativeReader::refused(int error) {
    fail_damaged(ffmpeg_reason(error));
}

std::optional<recording::FrameFacts> NativeReader::facts_of(std::span<const std::uint8_t> bytes) const {
    auto facts = recording::get_facts(bytes);
    if (facts && bytes.size() > recording::facts_size) {
        auto sensors = recording::get_sensors(bytes.subspan(recording::facts_size));
        if (!sensors) {
            fail_damaged("the samples of the sensors cannot be read");
        }
        facts->sensors = std::move(*sensors);
    }
    return facts;
}

recording::FrameFacts NativeReader::take_facts(const AVFrame& frame) {
    if (facts_.empty()) {  // the decoder made more frames than it was given packets
        fail_changed_picture(frame);
    }
    recording::FrameFacts facts = std::move(facts_.front());
    facts_.pop_front();
    count_gap(facts);
    return facts;
}

/// Counts frames that a damaged file lacks inside as lost before the next one: the numbers count every frame, recorded
/// or lost. Numbers of another program's cuts mean nothing, nor those after a gap of the source.
void NativeReader::count_gap(recording::FrameFacts& facts) {
    constexpr std::uint64_t most_missing = 1'000'000;  // with more, the number itself is damaged
    const bool follows = next_sequence_ && !edited_ && (facts.flags & frame_flag_discontinuity) == 0;
    if (follows && facts.sequence > *next_sequence_ + facts.dropped_before) {
        const std::uint64_t missing = facts.sequence - *next_sequence_ - facts.dropped_before;
        facts.dropped_before += missing <= most_missing ? static_cast<std::uint32_t>(missing) : 0;
    }
    next_sequence_ = facts.sequence + 1;
}

void NativeReader::check_end() const {
    check_file_size();
    if (!edited_ && !input().says_its_size()) {
        fail_truncated("the recorder was stopped before it closed the file, or wrote into a pipe");
    }
    check_end_error();
    if (info_.frame_count && frames() < *info_.frame_count) {
        fail_truncated("frames are missing inside the file");
    }
}

}  // namespace disparityd::capture
