// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "capture/camera/camera_format.h"
#include "capture/eye_layout.h"
#include "capture/usb/usb_camera.h"
#include "kernels/raw_image.h"

namespace disparityd::capture {

/// Which camera; empty = any. All that are given must hold.
struct CameraName {
    std::string serial;
    std::string device;  ///< node, or a link to one such as those in /dev/v4l/by-id
    std::string port;    ///< place on the USB, such as "2-1.4"

    /// " with serial 12345", " /dev/video0", " at USB port 2-1.4"
    std::string text() const;

    bool operator==(const CameraName&) const = default;
};

/// What a URI such as "v4l2:hd720@30?serial=12345" asks for. "v4l2:auto" is the first ZED camera that is there, with
/// hd720 at 30 frames per second. "v4l2:640x480@30?left=/dev/video0&right=/dev/video2" asks for two cameras.
struct CameraRequest : CameraName {
    std::string mode;     ///< name of a ZED mode; empty: a size was given
    int frame_width = 0;  ///< the whole frame of a camera: of both eyes, or of one where `right` is set; pixels
    int frame_height = 0;
    double rate = 30;
    const CameraFormat* sent = camera_format_of_name("yuyv");  ///< never nullptr
    std::uint32_t forced = 0;  ///< what the driver is asked for, whatever it calls it; 0: the format
    bool top_bottom = false;   ///< one eye above the other instead of beside it
    bool right_first = false;  ///< the right eye is the left or upper one

    /// The camera of the right eye, where each eye has one; the request's own name is then that of the left one.
    std::optional<CameraName> right;
    std::int64_t within_ns = 0;  ///< with `right`: stamps of the two frames of a pair are at most so far apart
    bool half_of_pair = false;   ///< the frame shows one eye (request_of_eye())

    int eye_width() const { return top_bottom || sent->interleaved() || right ? frame_width : frame_width / 2; }
    int eye_height() const { return top_bottom ? frame_height / 2 : frame_height; }

    EyeLayout layout() const { return {eye_width(), eye_height(), top_bottom, right_first, sent->interleaved()}; }

    PixelFormat format() const { return sent->lent; }
    bool mjpeg() const { return sent->packing == Packing::jpeg; }

    /// A mode of ZED cameras means one of those: not whatever else has this size while the ZED is unplugged.
    bool zed_only() const { return !mode.empty() && device.empty() && port.empty(); }

    /// "camera with serial 12345", "camera /dev/video0", "ZED camera", "cameras /dev/video0 (left) and ..."
    std::string wanted() const;
};

bool is_camera(const std::string& uri);

/// Throws std::invalid_argument with one line that says what was found and what is allowed.
CameraRequest parse_camera_uri(const std::string& uri);

/// What the camera of one eye is asked for, where each eye has one: its frame passes for one of two eyes side by side,
/// which are the halves of the one eye.
CameraRequest request_of_eye(const CameraRequest& pair, Eye eye);

/// Returns those of the cameras that may be meant, ZED cameras first; with a ZED mode's name and neither node nor port,
/// ZED cameras only. Serial numbers are not compared: some cameras tell theirs only when they are asked.
std::vector<UsbCamera> candidates(const std::vector<UsbCamera>& cameras, const CameraRequest& request);

}  // namespace disparityd::capture
