// SPDX-License-Identifier: Apache-2.0
#include "capture/recording/foreign_reader.h"

extern "C" {
#include <libavutil/display.h>
#include <libavutil/spherical.h>
#include <libavutil/stereo3d.h>
}

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "base/message_text.h"
#include "capture/frame_source.h"
#include "capture/recording/recording_ffmpeg.h"

namespace disparityd::capture {
namespace {

/// What a video says about how its pictures are to be shown.
struct VideoLayout {
    bool side_by_side = false;           ///< it declares both eyes side by side, the left one in the left half
    std::optional<std::string> refusal;  ///< why its pictures cannot be taken as they are stored, and what to do
};

using Matrix = std::array<std::int32_t, 9>;

/// Takes what stands behind a pointer; a null pointer is no declaration.
VideoLayout layout(const std::uint8_t* matrix_bytes, const AVStereo3D* stereo, const AVSphericalMapping* sphere) {
    VideoLayout layout;
    Matrix matrix{};
    if (matrix_bytes != nullptr) {
        std::memcpy(matrix.data(), matrix_bytes, sizeof matrix);
    }
    const bool upright = matrix[1] == 0 && matrix[3] == 0 && matrix[0] > 0 && matrix[4] > 0;
    if (matrix_bytes != nullptr && !upright) {
        const double angle = av_display_rotation_get(matrix.data());
        layout.refusal = "declares that its pictures are to be turned" +
                         (std::isnan(angle) ? std::string(" or mirrored")
                                            : " by " + std::to_string(std::lround(angle)) + " degrees, or mirrored") +
                         ", which is not done here: \"ffmpeg -i IN -c:v ffv1 OUT.mkv\" turns them";
        return layout;
    }
    const std::string projection = sphere == nullptr ? "" : av_spherical_projection_name(sphere->projection);
    if (!projection.empty() && projection != "rectilinear") {
        layout.refusal = "declares that its pictures are parts of a sphere (" + projection +
                         "), expected those of a pinhole camera; ffmpeg's filter v360 makes them flat";
        return layout;
    }
    if (stereo == nullptr) {
        return layout;
    }
    const bool swapped = (stereo->flags & AV_STEREO3D_FLAG_INVERT) != 0;
    layout.side_by_side = stereo->type == AV_STEREO3D_SIDEBYSIDE && !swapped;
    if (stereo->type == AV_STEREO3D_2D) {
        layout.refusal = "declares that it shows one eye only (2D); name the video of each eye: left.mp4,right.mp4";
    } else if (!layout.side_by_side) {
        layout.refusal =
            std::string("declares the stereo layout \"") + av_stereo3d_type_name(stereo->type) +
            (swapped ? ", the right eye first" : "") +
            "\", expected side by side, the left eye in the left half; ffmpeg's filter stereo3d makes it so, "
            "as \"ffmpeg -i IN -vf stereo3d=abl:sbsl -c:v ffv1 OUT.mkv\" does from above and below";
    }
    return layout;
}

const std::uint8_t* side_data_of(const AVStream& stream, AVPacketSideDataType type, std::size_t least) {
#if LIBAVCODEC_VERSION_INT >= AV_VERSION_INT(60, 31, 102)
    const AVPacketSideData* const list = stream.codecpar->coded_side_data;
    const int count = stream.codecpar->nb_coded_side_data;
#else
    const AVPacketSideData* const list = stream.side_data;
    const int count = stream.nb_side_data;
#endif
    for (int i = 0; i < count; ++i) {
        if (list[i].type == type && static_cast<std::size_t>(list[i].size) >= least) {
            return list[i].data;
        }
    }
    return nullptr;
}

const std::uint8_t* side_data_of(const AVFrame& frame, AVFrameSideDataType type, std::size_t least) {
    const AVFrameSideData* const found = av_frame_get_side_data(&frame, type);
    return found != nullptr && static_cast<std::size_t>(found->size) >= least ? found->data : nullptr;
}

// Only the first two fields are read; later versions of FFmpeg add others behind them.
constexpr std::size_t stereo_size = offsetof(AVStereo3D, flags) + sizeof(int);
constexpr std::size_t sphere_size = sizeof(AVSphericalProjection);

/// Reads what the container declares for a stream: a rotation, and a stereo layout.
VideoLayout layout_of(const AVStream& stream) {
    return layout(
        side_data_of(stream, AV_PKT_DATA_DISPLAYMATRIX, sizeof(Matrix)),
        reinterpret_cast<const AVStereo3D*>(side_data_of(stream, AV_PKT_DATA_STEREO3D, stereo_size)),
        reinterpret_cast<const AVSphericalMapping*>(side_data_of(stream, AV_PKT_DATA_SPHERICAL, sphere_size)));
}

/// Reads what the codec declares in the video itself.
VideoLayout layout_of(const AVFrame& frame) {
    return layout(
        side_data_of(frame, AV_FRAME_DATA_DISPLAYMATRIX, sizeof(Matrix)),
        reinterpret_cast<const AVStereo3D*>(side_data_of(frame, AV_FRAME_DATA_STEREO3D, stereo_size)),
        reinterpret_cast<const AVSphericalMapping*>(side_data_of(frame, AV_FRAME_DATA_SPHERICAL, sphere_size)));
}

constexpr AVRational in_nanoseconds{1, 1'000'000'000};

}  // namespace

ForeignReader::ForeignReader(RecordingInput input, int track, Picture picture)
    : VideoReader(std::move(input), track), picture_(picture) {
    check_layout();
    info_.rate = guessed_rate();
    if (stream().nb_frames > 0) {
        info_.frame_count = static_cast<std::uint64_t>(stream().nb_frames);
    }
    open_decoder(static_cast<AVPixelFormat>(stream().codecpar->format));
}

/// Whether a picture holds both eyes cannot be seen for sure. What says nothing is told; what is too narrow for two
/// eyes is not cut in two.
void ForeignReader::check_layout() {
    const VideoLayout layout = layout_of(stream());
    const std::string& path = input().path();
    if (layout.refusal && (picture_ == Picture::both_eyes || !layout.side_by_side)) {
        throw std::invalid_argument(path + ": " + *layout.refusal);
    }
    if (picture_ == Picture::one_eye || layout.side_by_side) {
        return;
    }
    const int width = stream().codecpar->width;
    const int height = stream().codecpar->height;
    if (width / 2 < height) {
        throw std::invalid_argument(
            path + ": found a picture of " + base::size_text(width, height) +
            ", which is that of one eye; expected both eyes side by side, or the video of each: left.mp4,right.mp4. If "
            "it does hold both, let the file declare it: ffmpeg -i IN -c copy -metadata:s:v stereo_mode=left_right "
            "OUT.mkv");
    }
    info_.notices.push_back(path + ": declares no stereo layout; its left half is taken as the left eye, " +
                            base::size_text(width / 2, height));
}

double ForeignReader::guessed_rate() const {
    AVFormatContext& context = input().context();
    const AVRational rate = av_guess_frame_rate(&context, context.streams[stream().index], nullptr);
    return rate.num > 0 && rate.den > 0 ? recording::plausible_rate(av_q2d(rate)) : 0;
}

bool ForeignReader::accept(const AVPacket& packet) {
    cut_packet_ = (packet.flags & AV_PKT_FLAG_CORRUPT) != 0;
    if (cut_packet_) {
        // Inside a video a picture is lost; whether the file ends here shows when nothing follows.
        ++undecodable_;
        undecodable_why_ = "pictures are incomplete";
    }
    return !cut_packet_;
}

/// Videos cut out of longer ones begin with pictures that cannot be decoded: lost frames, not a fault.
void ForeignReader::refused(const std::string& why) {
    ++undecodable_;
    undecodable_why_ = why;
}

recording::FrameFacts ForeignReader::take_facts(const AVFrame& frame) {
    if (const auto refusal = frames() == 0 ? layout_of(frame).refusal : std::nullopt) {
        throw std::runtime_error(input().path() + ": " + *refusal);
    }
    recording::FrameFacts facts;
    next_sequence_ += undecodable_;
    facts.dropped_before = undecodable_;
    facts.sequence = next_sequence_++;
    if (undecodable_ > 0) {
        facts.flags |= frame_flag_discontinuity;
    }
    const std::uint32_t lost = std::exchange(undecodable_, 0);
    if ((frame.flags & AV_FRAME_FLAG_CORRUPT) != 0 || frame.decode_error_flags != 0) {
        facts.flags |= frame_flag_corrupt;
    }
    set_time(frame, lost);
    facts.monotonic_ns = last_time_ns_;
    facts.realtime_ns = last_time_ns_;
    return facts;
}

/// Sets the frame's distance from the first one; a frame without a time comes one period after its predecessor, and one
/// more for each picture that was lost between them.
void ForeignReader::set_time(const AVFrame& frame, std::uint32_t lost) {
    const std::int64_t pts = frame.best_effort_timestamp;
    if (pts != AV_NOPTS_VALUE) {
        first_pts_ = first_pts_.value_or(pts);
        // Unsigned, here and below: a damaged file may hold any two times.
        const std::uint64_t apart = static_cast<std::uint64_t>(pts) - static_cast<std::uint64_t>(*first_pts_);
        last_time_ns_ = av_rescale_q(static_cast<std::int64_t>(apart), stream().time_base, in_nanoseconds);
    } else if (frames() > 0 && info_.rate > 0) {
        last_time_ns_ = static_cast<std::int64_t>(static_cast<std::uint64_t>(last_time_ns_) +
                                                  (std::uint64_t{lost} + 1) *
                                                      static_cast<std::uint64_t>(std::llround(1e9 / info_.rate)));
    }
}

void ForeignReader::check_end() const {
    check_file_size();
    if (cut_packet_) {
        fail_truncated("the next one is incomplete");
    }
    check_end_error();
    if (frames() == 0 && undecodable_ > 0) {
        throw std::runtime_error(input().path() + ": no frame can be decoded: " + undecodable_why_);
    }
}

}  // namespace disparityd::capture
