// SPDX-License-Identifier: Apache-2.0
#include "capture/camera/camera_survey.h"

#include <linux/videodev2.h>

#include "capture/camera/camera_problem.h"
#include "capture/camera/zed_extension.h"

namespace disparityd::capture {

namespace {

/// Bounds the list of a driver that never ends it.
constexpr std::uint32_t longest_list = 256;

std::string four_characters(std::uint32_t format) {
    std::string text;
    for (unsigned shift = 0; shift < 32; shift += 8) {
        const auto letter = static_cast<char>((format >> shift) & 0x7fU);
        text += letter > ' ' ? letter : ' ';
    }
    return text;
}

std::vector<double> rates(VideoSystem& system, int device, std::uint32_t format, std::uint32_t width,
                          std::uint32_t height) {
    std::vector<double> list;
    for (std::uint32_t index = 0; index < longest_list; ++index) {
        v4l2_frmivalenum interval{};
        interval.index = index;
        interval.pixel_format = format;
        interval.width = width;
        interval.height = height;
        if (system.ioctl(device, VIDIOC_ENUM_FRAMEINTERVALS, &interval) != 0 ||
            interval.type != V4L2_FRMIVAL_TYPE_DISCRETE) {
            break;
        }
        if (interval.discrete.numerator > 0) {
            list.push_back(static_cast<double>(interval.discrete.denominator) / interval.discrete.numerator);
        }
    }
    return list;
}

void add_sizes(VideoSystem& system, int device, std::uint32_t format, std::vector<VideoMode>& modes) {
    for (std::uint32_t index = 0; index < longest_list; ++index) {
        v4l2_frmsizeenum size{};
        size.index = index;
        size.pixel_format = format;
        if (system.ioctl(device, VIDIOC_ENUM_FRAMESIZES, &size) != 0) {
            break;
        }
        const bool discrete = size.type == V4L2_FRMSIZE_TYPE_DISCRETE;
        const std::uint32_t width = discrete ? size.discrete.width : size.stepwise.max_width;
        const std::uint32_t height = discrete ? size.discrete.height : size.stepwise.max_height;
        modes.push_back({four_characters(format), static_cast<int>(width), static_cast<int>(height),
                         rates(system, device, format, width, height)});
        if (!discrete) {
            break;
        }
    }
}

std::vector<VideoMode> list_modes(VideoSystem& system, int device) {
    std::vector<VideoMode> modes;
    for (std::uint32_t index = 0; index < longest_list; ++index) {
        v4l2_fmtdesc format{};
        format.index = index;
        format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
        if (system.ioctl(device, VIDIOC_ENUM_FMT, &format) != 0) {
            break;
        }
        add_sizes(system, device, format.pixelformat, modes);
    }
    return modes;
}

/// Finds out whether another program streams: drivers give buffers to one at a time. Returns 0 or errno.
int ask_for_buffers(VideoSystem& system, int device) {
    v4l2_requestbuffers wanted{};
    wanted.count = 1;
    wanted.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    wanted.memory = V4L2_MEMORY_MMAP;
    const int code = system.ioctl(device, VIDIOC_REQBUFS, &wanted);
    wanted.count = 0;
    if (code == 0) {
        system.ioctl(device, VIDIOC_REQBUFS, &wanted);
    }
    return code;
}

CameraSurvey survey(VideoSystem& system, UsbCamera camera) {
    CameraSurvey result;
    if (camera.zed() != nullptr && !camera.node.empty()) {
        const std::string serial = read_zed_serial(system, camera.node).text;
        camera.serial = serial.empty() ? camera.serial : serial;
    }
    result.camera = camera;
    result.notices = camera_notices(camera);
    // The empty request names no mode, so only problems of every mode are found.
    if (const auto problem = diagnose(camera, {})) {
        result.problem = problem->detail;
        return result;
    }
    const int device = system.open(camera.node);
    if (device < 0) {
        result.problem = diagnose({VideoError::Call::open, -device, camera.node}, camera, camera.label()).detail;
        return result;
    }
    result.modes = list_modes(system, device);
    if (const int code = ask_for_buffers(system, device); code != 0) {
        result.problem = diagnose({VideoError::Call::buffers, code, camera.node}, camera, camera.label()).detail;
    }
    system.close(device);
    return result;
}

}  // namespace

std::vector<CameraSurvey> survey_cameras(VideoSystem& system) {
    std::vector<CameraSurvey> list;
    for (const UsbCamera& camera : system.cameras()) {
        list.push_back(survey(system, camera));
    }
    return list;
}

}  // namespace disparityd::capture
