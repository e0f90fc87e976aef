// SPDX-License-Identifier: Apache-2.0
#include "bridges/ros_messages/camera_info_message.h"

namespace disparityd::ros {
namespace {

using disparity::Frame;

/// Returns what the images of the frame show of the whole image.
Region region_of(const Frame& frame) {
    for (const disparity::PlaneData& plane : frame.planes) {
        const bool image = plane.product != disparity::Product::scan;
        if (image && (plane.width != frame.width || plane.height != frame.height)) {
            return {frame.region_x, frame.region_y, plane.width, plane.height};
        }
    }
    return {};
}

}  // namespace

std::optional<std::string> camera_info(const Frame& frame, Camera camera, const FrameNames& names) {
    if (frame.f <= 0 || frame.baseline_mm <= 0 || (frame.flags & disparity::unrectified) != 0) {
        return std::nullopt;
    }
    const std::array<double, 12> p = projection(frame, camera);
    return camera_info_message({.realtime_ns = frame.realtime_ns,
                                .frame = names.left,
                                .width = frame.width,
                                .height = frame.height,
                                .k = {p[0], p[1], p[2], p[4], p[5], p[6], p[8], p[9], p[10]},
                                .p = p,
                                .region = region_of(frame)});
}

std::string_view distortion_model(bool fisheye, std::size_t coefficients) {
    constexpr std::size_t plumb_bob_numbers = 5;
    if (fisheye) {
        return "equidistant";
    }
    return coefficients == plumb_bob_numbers ? "plumb_bob" : "rational_polynomial";
}

std::array<double, 12> projection(double f, double cx, double cy, double shift) {
    return {f, 0, cx, shift, 0, f, cy, 0, 0, 0, 1, 0};
}

std::array<double, 12> projection(const Frame& frame, Camera camera) {
    // d + offset = f B / Z and d = x - x', so the right camera's principal point is the offset farther right.
    const bool right = camera == Camera::right;
    return projection(frame.f, frame.cx + (right ? frame.disparity_offset : 0), frame.cy,
                      right ? -frame.f * frame.baseline_mm / 1000 : 0);
}

std::string camera_info_message(const CameraInfoFields& fields) {
    CdrWriter cdr(512);
    write_header(cdr, fields.realtime_ns, fields.frame);
    cdr.u32(fields.height).u32(fields.width).text(fields.model).f64_sequence(fields.d);
    cdr.f64_array(fields.k).f64_array(fields.r).f64_array(fields.p);
    cdr.u32(0).u32(0);  // no binning
    write_region(cdr, fields.region);
    return cdr.take();
}

}  // namespace disparityd::ros
