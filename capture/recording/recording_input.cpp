// SPDX-License-Identifier: Apache-2.0
#include "capture/recording/recording_input.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <vector>

#include "base/error_text.h"
#include "base/words.h"
#include "capture/recording/other_recordings.h"
#include "capture/recording/recording_format.h"

namespace disparityd::capture {
namespace {

std::uint64_t readable_size(const std::string& path) {
    std::error_code error;
    const auto status = std::filesystem::status(path, error);
    if (!std::filesystem::exists(status)) {
        throw std::invalid_argument(path + ": cannot open the recording: " +
                                    (error ? base::error_text(error.value()) : std::string("no such file")));
    }
    if (!std::filesystem::is_regular_file(status)) {
        throw std::invalid_argument(path + ": is not a file; a recording is one video file");
    }
    const auto size = std::filesystem::file_size(path, error);
    if (error) {
        throw std::runtime_error(path + ": cannot read the recording: " + base::error_text(error.value()));
    }
    if (size == 0) {
        throw std::invalid_argument(path + ": is empty; expected a recording or another video file");
    }
    return size;
}

std::vector<std::uint8_t> head_of(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) {
        throw std::runtime_error(path + ": cannot read the recording: " + base::error_text(errno));
    }
    std::vector<std::uint8_t> head(65536);
    file.read(reinterpret_cast<char*>(head.data()), static_cast<std::streamsize>(head.size()));
    head.resize(static_cast<std::size_t>(file.gcount()));
    return head;
}

bool contains(const std::vector<std::uint8_t>& bytes, std::string_view text) {
    return std::search(bytes.begin(), bytes.end(), text.begin(), text.end()) != bytes.end();
}

}  // namespace

RecordingInput::RecordingInput(const std::string& path) : path_(path), file_size_(readable_size(path)) {
    keep_ffmpeg_log();
    const std::vector<std::uint8_t> head = head_of(path);
    if (const auto what = known_otherwise(path, head)) {
        throw std::invalid_argument(path + ": " + *what);
    }
    segment_ = find_segment(head);
    has_native_tags_ = segment_ && contains(head, recording::tag_prefix);
    open(segment_ && contains(head, recording::tag_format));
}

void RecordingInput::open(bool has_native_tag) {
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
    if (result < 0 && has_native_tag) {  // FFmpeg opens no Matroska file without frames
        throw std::invalid_argument(path_ + ": the recording holds no frames");
    }
    if (result < 0) {  // FFmpeg has freed the context
        throw std::invalid_argument(path_ +
                                    ": is not a recording or another video that can be read: " + ffmpeg_reason(result));
    }
    context_.reset(made);
    if (std::strcmp(context_->iformat->name, "tty") == 0) {  // FFmpeg draws text files as pictures
        throw std::invalid_argument(path_ + ": is not a video: found text");
    }
}

const char* RecordingInput::tag(const char* key) const {
    const AVDictionaryEntry* entry = av_dict_get(context_->metadata, key, nullptr, 0);
    return entry == nullptr ? nullptr : entry->value;
}

void RecordingInput::probe() {
    // No picture that is too large is decoded.
    std::vector<AVDictionary*> options(context_->nb_streams, nullptr);
    for (AVDictionary*& of_stream : options) {
        av_dict_set_int(&of_stream, "max_pixels", recording::max_pixels, 0);
    }
    clear_ffmpeg_log();
    const int result = avformat_find_stream_info(context_.get(), options.data());
    for (AVDictionary*& of_stream : options) {
        av_dict_free(&of_stream);
    }
    if (result < 0) {
        throw std::invalid_argument(path_ + ": is not a video that can be read: " + ffmpeg_reason(result));
    }
}

std::vector<int> RecordingInput::video_tracks() const {
    std::vector<int> tracks;
    for (unsigned i = 0; i < context_->nb_streams; ++i) {
        const AVStream& stream = *context_->streams[i];
        if (stream.codecpar->codec_type == AVMEDIA_TYPE_VIDEO &&
            (stream.disposition & AV_DISPOSITION_ATTACHED_PIC) == 0) {
            tracks.push_back(static_cast<int>(i));
        }
    }
    return tracks;
}

std::string RecordingInput::track_name(int track) const {
    std::string names;
    for (const char* key : {"title", "handler_name"}) {
        const AVDictionaryEntry* entry = av_dict_get(context_->streams[track]->metadata, key, nullptr, 0);
        names += entry == nullptr ? std::string() : std::string(" ") + entry->value;
    }
    return base::lower_case(names);
}

void RecordingInput::choose_video(int chosen) {
    for (unsigned i = 0; i < context_->nb_streams; ++i) {
        if (static_cast<int>(i) != chosen) {
            context_->streams[i]->discard = AVDISCARD_ALL;
        }
    }
}

int RecordingInput::only_video() const {
    const std::vector<int> tracks = video_tracks();
    if (tracks.empty()) {
        throw std::invalid_argument(path_ + ": has no video stream (found: " + context_->iformat->long_name + ")");
    }
    if (tracks.size() > 1) {
        throw std::invalid_argument(path_ + ": has " + std::to_string(tracks.size()) +
                                    " video streams, expected one with both eyes side by side, or one for each eye");
    }
    return tracks.front();
}

std::optional<std::string> RecordingInput::missing_bytes() const {
    if (!says_its_size() || segment_->data_offset + *segment_->size <= file_size_) {
        return std::nullopt;
    }
    return std::to_string(file_size_) + " of " + std::to_string(segment_->data_offset + *segment_->size) +
           " bytes are there";
}

}  // namespace disparityd::capture
