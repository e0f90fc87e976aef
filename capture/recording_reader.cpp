// SPDX-License-Identifier: Apache-2.0
#include "capture/recording_reader.h"

extern "C" {
#include <libavutil/pixdesc.h>
}

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <vector>

#include "capture/frame_source.h"
#include "capture/number_text.h"
#include "capture/pixel_format.h"
#include "capture/recording_sensors.h"

namespace disparityd::capture {
namespace {

constexpr AVRational in_nanoseconds{1, 1'000'000'000};

std::uint64_t checked_size(const std::string& path) {
    std::error_code error;
    const auto status = std::filesystem::status(path, error);
    if (!std::filesystem::exists(status)) {
        throw std::invalid_argument(
            path + ": cannot open the recording: " + (error ? error.message() : std::string("no such file")));
    }
    if (!std::filesystem::is_regular_file(status)) {
        throw std::invalid_argument(path + ": is not a file; a recording is one video file");
    }
    const auto size = std::filesystem::file_size(path, error);
    if (error) {
        throw std::runtime_error(path + ": cannot read the recording: " + error.message());
    }
    if (size == 0) {
        throw std::invalid_argument(path + ": is empty; expected a recording or another video file");
    }
    return size;
}

std::vector<std::uint8_t> head_of(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) {
        throw std::runtime_error(path + ": cannot read the recording: " + std::generic_category().message(errno));
    }
    std::vector<std::uint8_t> head(65536);
    file.read(reinterpret_cast<char*>(head.data()), static_cast<std::streamsize>(head.size()));
    head.resize(static_cast<std::size_t>(file.gcount()));
    return head;
}

bool contains(const std::vector<std::uint8_t>& bytes, std::string_view text) {
    return std::search(bytes.begin(), bytes.end(), text.begin(), text.end()) != bytes.end();
}

std::optional<std::uint64_t> whole_number(std::string_view text) {
    std::uint64_t value = 0;
    const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
    if (result.ec != std::errc{} || result.ptr != text.data() + text.size()) {
        return std::nullopt;
    }
    return value;
}

std::string bytes_text(std::uint64_t part, std::uint64_t whole) {
    return std::to_string(part) + " of " + std::to_string(whole) + " bytes are there";
}

}  // namespace

RecordingReader::RecordingReader(const std::string& path) : path_(path), file_size_(checked_size(path)) {
    keep_ffmpeg_log();
    const std::vector<std::uint8_t> head = head_of(path);
    segment_ = find_segment(head);
    packet_.reset(or_bad_alloc(av_packet_alloc()));
    frame_.reset(or_bad_alloc(av_frame_alloc()));
    open_file(segment_ && contains(head, recording::tag_format));
    choose_stream();
    read_facts_of_file();
    open_decoder();
    check_size();
}

std::size_t RecordingReader::frame_bytes() const {
    return 2 * static_cast<std::size_t>(info_.eye_width) * static_cast<std::size_t>(info_.height) *
           static_cast<std::size_t>(bytes_per_pixel(info_.format));
}

void RecordingReader::open_file(bool has_our_tag) {
    AVFormatContext* made = or_bad_alloc(avformat_alloc_context());
    AVDictionary* options = nullptr;
    // A playlist must not make the daemon open other files or connections: formats that hold all there is in one file
    // ("tty" is here for a message of its own).
    av_dict_set(&options, "protocol_whitelist", "file", 0);
    av_dict_set(&options, "format_whitelist",
                "matroska,webm,mov,avi,mpegts,mpeg,mpegvideo,yuv4mpegpipe,ogg,nut,asf,flv,wav,tty", 0);
    clear_ffmpeg_log();
    const int result = avformat_open_input(&made, ("file:" + path_).c_str(), nullptr, &options);
    av_dict_free(&options);
    if (result < 0 && has_our_tag) {  // FFmpeg opens no Matroska file without frames
        throw std::invalid_argument(path_ + ": the recording holds no frames");
    }
    if (result < 0) {  // FFmpeg has freed the context
        throw std::invalid_argument(path_ +
                                    ": is not a recording or another video that can be read: " + ffmpeg_reason(result));
    }
    input_.reset(made);
    if (std::strcmp(input_->iformat->name, "tty") == 0) {  // FFmpeg draws text files as pictures
        throw std::invalid_argument(path_ + ": is not a video: found text");
    }
}

void RecordingReader::choose_stream() {
    info_.ours = tag(recording::tag_format) != nullptr;
    if (!info_.ours) {
        clear_ffmpeg_log();
        if (const int result = avformat_find_stream_info(input_.get(), nullptr); result < 0) {
            throw std::invalid_argument(path_ + ": is not a video that can be read: " + ffmpeg_reason(result));
        }
    }
    stream_ = av_find_best_stream(input_.get(), AVMEDIA_TYPE_VIDEO, -1, -1, nullptr, 0);
    if (stream_ < 0 || (input_->streams[stream_]->disposition & AV_DISPOSITION_ATTACHED_PIC) != 0) {
        throw std::invalid_argument(path_ + ": has no video stream (found: " + input_->iformat->long_name + ")");
    }
    for (unsigned i = 0; i < input_->nb_streams; ++i) {
        if (static_cast<int>(i) != stream_) {
            input_->streams[i]->discard = AVDISCARD_ALL;
        }
    }
}

const char* RecordingReader::tag(const char* key) const {
    const AVDictionaryEntry* entry = av_dict_get(input_->metadata, key, nullptr, 0);
    return entry == nullptr ? nullptr : entry->value;
}

std::string_view RecordingReader::required_tag(const char* key) const {
    const char* text = tag(key);
    if (text == nullptr) {
        throw std::invalid_argument(path_ + ": the recording is damaged: its tag " + key + " is missing");
    }
    return text;
}

std::invalid_argument RecordingReader::damaged_tag(const char* key) const {
    return std::invalid_argument(path_ + ": the recording is damaged: its tag " + key + " says \"" + tag(key) + "\"");
}

void RecordingReader::read_facts_of_file() {
    const AVStream& stream = *input_->streams[stream_];
    info_.height = stream.codecpar->height;
    info_.eye_width = stream.codecpar->width / 2;
    info_.codec = avcodec_get_name(stream.codecpar->codec_id);
    if (info_.ours) {
        read_tags();
        return;
    }
    info_.rate = foreign_rate();
    if (stream.nb_frames > 0) {
        info_.frame_count = static_cast<std::uint64_t>(stream.nb_frames);
    }
}

void RecordingReader::read_tags() {
    if (recording::format_version != tag(recording::tag_format)) {
        throw std::invalid_argument(path_ + ": is a recording of format " + tag(recording::tag_format) +
                                    ", this program reads format " + std::string(recording::format_version));
    }
    const auto format = pixel_format_from_name(required_tag(recording::tag_pixels));
    if (!format || input_->streams[stream_]->codecpar->codec_id != AV_CODEC_ID_FFVHUFF) {
        throw damaged_tag(recording::tag_pixels);
    }
    info_.format = *format;
    if (whole_number(required_tag(recording::tag_eye_width)) != static_cast<std::uint64_t>(info_.eye_width)) {
        throw damaged_tag(recording::tag_eye_width);
    }
    const auto rate = parse_number(required_tag(recording::tag_rate));
    if (!rate || (*rate != 0 && *rate != recording::plausible_rate(*rate))) {
        throw damaged_tag(recording::tag_rate);
    }
    info_.rate = *rate;
    // Zero until the file is closed.
    const auto frames = whole_number(required_tag(recording::tag_frames));
    if (frames && *frames > 0) {
        info_.frame_count = frames;
    }
    if (const char* source = tag(recording::tag_source)) {
        info_.source = source;
    }
    if (const char* calibration = tag(recording::tag_calibration)) {
        if (required_tag(recording::tag_calibration_id) != recording::calibration_identity(calibration)) {
            throw damaged_tag(recording::tag_calibration_id);
        }
        info_.calibration_text = calibration;
    }
}

double RecordingReader::foreign_rate() const {
    const AVRational rate = av_guess_frame_rate(input_.get(), input_->streams[stream_], nullptr);
    return rate.num > 0 && rate.den > 0 ? recording::plausible_rate(av_q2d(rate)) : 0;
}

void RecordingReader::open_decoder() {
    const AVCodecParameters& parameters = *input_->streams[stream_]->codecpar;
    const AVCodec* codec = avcodec_find_decoder(parameters.codec_id);
    if (codec == nullptr) {
        throw std::invalid_argument(path_ + ": this FFmpeg has no decoder for " + info_.codec);
    }
    decoder_.reset(or_bad_alloc(avcodec_alloc_context3(codec)));
    if (avcodec_parameters_to_context(decoder_.get(), &parameters) < 0) {
        throw std::bad_alloc();
    }
    decoder_->pkt_timebase = input_->streams[stream_]->time_base;
    decoder_->thread_count = 1;  // the source decodes ahead already; the cores belong to the matcher
    clear_ffmpeg_log();
    if (const int result = avcodec_open2(decoder_.get(), codec, nullptr); result < 0) {
        throw std::invalid_argument(path_ + ": cannot decode " + info_.codec + ": " + ffmpeg_reason(result));
    }
    const int width = parameters.width;
    const int height = parameters.height;
    if (width < 1 || height < 1 || width > recording::max_side || height > recording::max_side ||
        std::int64_t{width} * height > recording::max_pixels) {
        throw std::invalid_argument(path_ + ": found a picture of " + std::to_string(width) + " x " +
                                    std::to_string(height) + ", allowed up to " + std::to_string(recording::max_side) +
                                    " each way and " + std::to_string(recording::max_pixels) + " pixels");
    }
    const AVPixelFormat stored =
        info_.ours ? stored_format(info_.format) : static_cast<AVPixelFormat>(parameters.format);
    try {
        loader_ = std::make_unique<PixelLoader>(stored, width, height);
    } catch (const std::invalid_argument& error) {
        throw std::invalid_argument(path_ + ": cannot be used as frames: " + error.what());
    }
    info_.format = loader_->format();
}

void RecordingReader::check_size() const {
    const int width = input_->streams[stream_]->codecpar->width;
    if (width % 2 != 0) {
        throw std::invalid_argument(path_ + ": found a picture " + std::to_string(width) +
                                    " pixels wide, expected two eyes side by side: an even width");
    }
    if (info_.format == PixelFormat::yuyv && width % 4 != 0) {
        throw std::invalid_argument(path_ + ": found a YUV 4:2:2 picture " + std::to_string(width) +
                                    " pixels wide, expected two eyes of even width side by side: a multiple of 4");
    }
}

bool RecordingReader::read(recording::FrameFacts& facts, std::uint8_t* pixels) {
    if (ended_) {
        return false;
    }
    ended_ = true;  // unless a whole frame comes out: errors end the video, too
    while (!receive_frame()) {
        if (draining_) {
            check_end();
            return false;
        }
        send_packet();
    }
    check_picture();
    facts = take_facts();
    loader_->load(*frame_, pixels);
    av_frame_unref(frame_.get());
    ++frames_;
    ended_ = false;
    return true;
}

bool RecordingReader::receive_frame() {
    clear_ffmpeg_log();
    const int result = avcodec_receive_frame(decoder_.get(), frame_.get());
    if (result >= 0) {
        return true;
    }
    if (result != AVERROR(EAGAIN) && result != AVERROR_EOF) {
        throw std::runtime_error(path_ + ": damaged after " + frames_read() + ": " + ffmpeg_reason(result));
    }
    return false;
}

/// Gives the decoder the next packet, or tells it that there are no more.
void RecordingReader::send_packet() {
    int result = 0;
    do {
        av_packet_unref(packet_.get());
        clear_ffmpeg_log();
        result = av_read_frame(input_.get(), packet_.get());
    } while (result >= 0 && packet_->stream_index != stream_);
    if (result < 0) {
        end_error_ = result;
        draining_ = true;
        avcodec_send_packet(decoder_.get(), nullptr);
        return;
    }
    cut_packet_ = (packet_->flags & AV_PKT_FLAG_CORRUPT) != 0;
    if (cut_packet_ && !info_.ours) {
        // Inside a video a picture is lost; whether the file ends here shows when nothing follows.
        ++undecodable_;
        undecodable_why_ = "pictures are incomplete";
        av_packet_unref(packet_.get());
        return;
    }
    check_packet();
    clear_ffmpeg_log();
    result = avcodec_send_packet(decoder_.get(), packet_.get());
    av_packet_unref(packet_.get());
    if (result < 0 && info_.ours) {
        throw std::runtime_error(path_ + ": damaged after " + frames_read() + ": " + ffmpeg_reason(result));
    }
    if (result < 0) {
        // Videos cut out of longer ones begin with pictures that cannot be decoded: lost frames, not a fault.
        ++undecodable_;
        undecodable_why_ = ffmpeg_reason(result);
    }
}

void RecordingReader::check_packet() {
    if (!info_.ours) {
        return;
    }
    if (cut_packet_) {
        fail_truncated("the next one is incomplete");
    }
    std::optional<recording::FrameFacts> facts;
    for (int i = 0; i < packet_->side_data_elems; ++i) {
        const AVPacketSideData& side = packet_->side_data[i];
        if (side.type == AV_PKT_DATA_MATROSKA_BLOCKADDITIONAL) {
            facts = facts_of({side.data, static_cast<std::size_t>(side.size)});
        }
    }
    if (!facts) {
        fail_truncated("the next one has no times");
    }
    facts_.push_back(std::move(*facts));
}

std::optional<recording::FrameFacts> RecordingReader::facts_of(std::span<const std::uint8_t> bytes) const {
    auto facts = recording::get_facts(bytes);
    if (facts && bytes.size() > recording::facts_size) {
        auto sensors = recording::get_sensors(bytes.subspan(recording::facts_size));
        if (!sensors) {
            throw std::runtime_error(path_ + ": damaged after " + frames_read() + ": bad samples of the sensors");
        }
        facts->sensors = std::move(*sensors);
    }
    return facts;
}

recording::FrameFacts RecordingReader::take_facts() {
    if (info_.ours) {
        recording::FrameFacts facts = std::move(facts_.front());
        facts_.pop_front();
        return facts;
    }
    recording::FrameFacts facts;
    next_sequence_ += undecodable_;
    facts.dropped_before = undecodable_;
    facts.sequence = next_sequence_++;
    if (undecodable_ > 0) {
        facts.flags |= frame_flag_discontinuity;
    }
    undecodable_ = 0;
    if ((frame_->flags & AV_FRAME_FLAG_CORRUPT) != 0 || frame_->decode_error_flags != 0) {
        facts.flags |= frame_flag_corrupt;
    }
    const std::int64_t pts = frame_->best_effort_timestamp;
    if (pts != AV_NOPTS_VALUE) {
        first_pts_ = first_pts_.value_or(pts);
        // Unsigned, here and below: a damaged file may hold any two times.
        const std::uint64_t apart = static_cast<std::uint64_t>(pts) - static_cast<std::uint64_t>(*first_pts_);
        last_time_ns_ =
            av_rescale_q(static_cast<std::int64_t>(apart), input_->streams[stream_]->time_base, in_nanoseconds);
    } else if (frames_ > 0 && info_.rate > 0) {
        last_time_ns_ = static_cast<std::int64_t>(static_cast<std::uint64_t>(last_time_ns_) +
                                                  static_cast<std::uint64_t>(std::llround(1e9 / info_.rate)));
    }
    facts.monotonic_ns = last_time_ns_;
    facts.realtime_ns = last_time_ns_;
    return facts;
}

void RecordingReader::check_picture() const {
    const AVCodecParameters& expected = *input_->streams[stream_]->codecpar;
    const int format = info_.ours ? stored_format(info_.format) : expected.format;
    if (frame_->width == expected.width && frame_->height == expected.height && frame_->format == format &&
        (!info_.ours || !facts_.empty())) {
        return;
    }
    auto text = [](int width, int height, int pixels) {
        const char* pixel_name = av_get_pix_fmt_name(static_cast<AVPixelFormat>(pixels));
        return std::to_string(width) + " x " + std::to_string(height) + " " +
               (pixel_name == nullptr ? "unknown" : pixel_name);
    };
    throw std::runtime_error(path_ + ": the picture changes after " + frames_read() + ": found " +
                             text(frame_->width, frame_->height, frame_->format) + ", the video began with " +
                             text(expected.width, expected.height, format));
}

/// Throws when the file ended before its time. Everything whole has been read by then.
void RecordingReader::check_end() const {
    if (segment_ && segment_->size && segment_->data_offset + *segment_->size > file_size_) {
        fail_truncated("the file was cut: " + bytes_text(file_size_, segment_->data_offset + *segment_->size));
    }
    if (info_.ours && (!segment_ || !segment_->size)) {
        fail_truncated("the recorder was stopped before it closed the file, or wrote into a pipe");
    }
    if (cut_packet_) {
        fail_truncated("the next one is incomplete");
    }
    if (end_error_ != AVERROR_EOF) {
        throw std::runtime_error(path_ + ": damaged after " + frames_read() + ": " + ffmpeg_reason(end_error_));
    }
    if (info_.ours && info_.frame_count && frames_ < *info_.frame_count) {
        fail_truncated("frames are missing inside the file");
    }
    if (!info_.ours && frames_ == 0 && undecodable_ > 0) {
        throw std::runtime_error(path_ + ": no frame can be decoded: " + undecodable_why_);
    }
}

void RecordingReader::fail_truncated(const std::string& how) const {
    throw std::runtime_error(path_ + ": truncated: " + frames_read() + " could be read, " + how);
}

std::string RecordingReader::frames_read() const {
    if (info_.frame_count) {
        return std::to_string(frames_) + " of " + std::to_string(*info_.frame_count) + " frames";
    }
    return std::to_string(frames_) + (frames_ == 1 ? " frame" : " frames");
}

}  // namespace disparityd::capture
