// SPDX-License-Identifier: Apache-2.0
#include "capture/recording/video_layout.h"

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

namespace disparityd::capture {
namespace {

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

}  // namespace

VideoLayout layout_of(const AVStream& stream) {
    return layout(
        side_data_of(stream, AV_PKT_DATA_DISPLAYMATRIX, sizeof(Matrix)),
        reinterpret_cast<const AVStereo3D*>(side_data_of(stream, AV_PKT_DATA_STEREO3D, stereo_size)),
        reinterpret_cast<const AVSphericalMapping*>(side_data_of(stream, AV_PKT_DATA_SPHERICAL, sphere_size)));
}

VideoLayout layout_of(const AVFrame& frame) {
    return layout(
        side_data_of(frame, AV_FRAME_DATA_DISPLAYMATRIX, sizeof(Matrix)),
        reinterpret_cast<const AVStereo3D*>(side_data_of(frame, AV_FRAME_DATA_STEREO3D, stereo_size)),
        reinterpret_cast<const AVSphericalMapping*>(side_data_of(frame, AV_FRAME_DATA_SPHERICAL, sphere_size)));
}

}  // namespace disparityd::capture
