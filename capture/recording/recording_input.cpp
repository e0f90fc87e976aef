// SPDX-License-Identifier: Apache-2.0
#include "capture/recording/recording_input.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "base/failure_text.h"
#include "base/words.h"
#include "capture/recording/recording_format.h"
#include "formats/unpack.h"

namespace disparityd::capture {
namespace {

using namespace std::string_view_literals;

constexpr const char* as_svo =
    "is a recording of the ZED SDK before 4.1 (SVO 1), which only that SDK can read; its sample \"SVO Export\" makes a "
    "side-by-side AVI or images of it, and both are read here";
constexpr const char* as_svo2 =
    "is a recording of the ZED SDK (SVO2), which holds both eyes: name it alone, with a name that ends in .svo2";
constexpr const char* as_bag =
    "is a ROS bag: give it a name that ends in .bag (ROS 1) or .db3 (ROS 2), so that it is read as one";

constexpr const char* as_zstd = "is compressed with zstd: unpack it, ";

struct OtherKind {
    std::string_view begins;  ///< the file's first bytes
    const char* what;
    std::size_t at = 0;  ///< where these stand
};

constexpr const char* as_other_image =
    "is an image of a kind that is not read; convert it, and that of the other eye, to PNG";

constexpr std::array other_kinds{
    OtherKind{"\0SVO"sv, as_svo},
    OtherKind{"#ROSBAG"sv, as_bag},
    OtherKind{"SQLite format 3\0"sv, as_bag},
    OtherKind{"\x89MCAP"sv, "is an MCAP file: give it a name that ends in .mcap, so that it is read as a ROS 2 bag"},
    OtherKind{"PK\x03\x04"sv, "is a ZIP archive: unpack it"},
    OtherKind{"\x1f\x8b"sv, "is compressed with gzip: unpack it"},
    OtherKind{"\xfd"
              "7zXZ"sv,
              "is compressed with xz: unpack it"},
    OtherKind{"\x28\xb5\x2f\xfd"sv, as_zstd},
    OtherKind{"7z\xbc\xaf"sv, "is a 7-Zip archive: unpack it"},
    OtherKind{"Rar!"sv, "is a RAR archive: unpack it"},
    OtherKind{"\x89HDF"sv, "is an HDF5 file, which is not read; expected a video or images"},
    OtherKind{"\x93NUMPY"sv, "is an array of NumPy, which is not read; expected a video or images"},
    OtherKind{"%PDF"sv, "is a PDF document; expected a video or images"},
    OtherKind{"\x7f"
              "ELF"sv,
              "is a program; expected a video or images"},
    OtherKind{"GIF8"sv, as_other_image},
    OtherKind{"\x76\x2f\x31\x01"sv, as_other_image},  // OpenEXR
    OtherKind{"\0\0\0\x0cJXL "sv, as_other_image},
    OtherKind{"ftyphei"sv, as_other_image, 4},
    OtherKind{"ftypmif1"sv, as_other_image, 4},
    OtherKind{"ftypavif"sv, as_other_image, 4},
    OtherKind{"Pf\n"sv, as_other_image},  // PFM, of which ground truth is read
    OtherKind{"PF\n"sv, as_other_image},
    OtherKind{
        "II*\0"sv,
        "is an image (TIFF, or raw data of a camera): give that of each eye, with names that end in .tif; convert "
        "raw data to PNG"},
    OtherKind{"MM\0*"sv, "is an image (TIFF): give that of each eye, with names that end in .tif"},
    OtherKind{"\x89PNG"sv, "is an image (PNG): give that of each eye, with names that end in .png"},
    OtherKind{"\xff\xd8\xff"sv, "is an image (JPEG): give that of each eye, with names that end in .jpg"},
};

/// Names a file that is no video but something else that people have: recordings of other programs, archives, images.
/// Returns what it is and how to get from there to something that is read; nothing where it is none of these. `head`
/// are its first bytes.
std::optional<std::string> known_otherwise(const std::string& path, std::span<const std::uint8_t> head) {
    const std::string ending = base::lower_case(std::filesystem::path(path).extension().string());
    if (ending == ".svo" || ending == ".svo2") {
        return ending == ".svo" ? as_svo : as_svo2;
    }
    const std::string_view bytes(reinterpret_cast<const char*>(head.data()), head.size());
    for (const OtherKind& kind : other_kinds) {
        if (bytes.substr(std::min(kind.at, bytes.size())).starts_with(kind.begins)) {
            return kind.what == as_zstd ? as_zstd + formats::zstd_command(path) : kind.what;
        }
    }
    return std::nullopt;
}

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
