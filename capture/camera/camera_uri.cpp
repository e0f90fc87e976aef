// SPDX-License-Identifier: Apache-2.0
#include "capture/camera/camera_uri.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "base/number_text.h"
#include "base/words.h"
#include "calibration/zed_modes.h"
#include "capture/source_uri.h"

namespace disparityd::capture {

namespace {

constexpr std::string_view scheme = "v4l2:";
constexpr const char* one_camera =
    "one, which sends the frames of both eyes; two cameras are left=/dev/video0&right=/dev/video2";

int size_number(const SourceUri& uri, std::string_view text) {
    const auto number = base::parse_number(text);
    if (!number || *number < 16 || *number > 16384 || *number != static_cast<int>(*number)) {
        uri.fail("size of the whole frame", text, "WIDTHxHEIGHT, each 16 to 16384");
    }
    return static_cast<int>(*number);
}

void read_mode(const SourceUri& uri, CameraRequest& request) {
    std::string name = base::lower_case(uri.name());
    if (name.empty() || name == "auto") {
        name = "hd720";
    }
    const calibration::ZedMode* mode = calibration::zed_mode_of_name(name);
    if (mode != nullptr) {
        request.mode = name;
        request.frame_width = 2 * mode->width;
        request.frame_height = mode->height;
        request.rate = std::min(30, mode->highest_rate);
        return;
    }
    const auto cross = name.find('x');
    if (cross == std::string::npos) {
        uri.fail("mode", uri.name(), "auto, hd2k, hd1080, hd720, vga, or the size of the whole frame such as 2560x720");
    }
    request.frame_width = size_number(uri, std::string_view(name).substr(0, cross));
    request.frame_height = size_number(uri, std::string_view(name).substr(cross + 1));
}

void read_format(const SourceUri& uri, const std::string& value, CameraRequest& request) {
    request.sent = camera_format_of_name(value);
    if (request.sent == nullptr) {
        uri.fail("format", value, camera_format_names());
    }
}

std::uint32_t forced_format(const SourceUri& uri, const std::string& value) {
    const bool printable = std::all_of(value.begin(), value.end(), [](char c) { return c > ' ' && c <= '~'; });
    if (value.size() > 4 || !printable) {
        uri.fail("force", value, "the driver's name of a format, such as Y16: 1 to 4 characters");
    }
    return fourcc_of(value);
}

/// Reads which camera has one eye: a node, or "port:" or "serial:" and the camera's.
CameraName eye_name(const std::string& value) {
    constexpr std::string_view port = "port:";
    constexpr std::string_view serial = "serial:";
    CameraName name;
    if (value.starts_with(port)) {
        name.port = value.substr(port.size());
    } else if (value.starts_with(serial)) {
        name.serial = value.substr(serial.size());
    } else {
        name.device = value;
    }
    return name;
}

void read_parameter(const SourceUri& uri, const SourceUri::Parameter& parameter, CameraRequest& request) {
    const std::string value(parameter.value);
    if (value.empty()) {
        uri.fail("parameter", parameter.text,
                 "serial=, device=, port=, left=, right=, within_ms=, format=, force=, layout= or first= with a value");
    }
    const bool names_a_camera = parameter.key == "serial" || parameter.key == "device" || parameter.key == "port";
    if (names_a_camera && value.find(',') != std::string::npos) {
        uri.fail(std::string(parameter.key), value, one_camera);
    }
    if (parameter.key == "serial") {
        request.serial = value;
    } else if (parameter.key == "device") {
        request.device = value;
    } else if (parameter.key == "port") {
        request.port = value;
    } else if (parameter.key == "left" || parameter.key == "right" || parameter.key == "within_ms") {
        return;  // read_pair()
    } else if (parameter.key == "format") {
        read_format(uri, value, request);
    } else if (parameter.key == "force") {
        request.forced = forced_format(uri, value);
    } else if (parameter.key == "layout") {
        if (value != "side-by-side" && value != "top-bottom") {
            uri.fail("layout", value, "side-by-side or top-bottom");
        }
        request.top_bottom = value == "top-bottom";
    } else if (parameter.key == "first") {
        if (value != "left" && value != "right") {
            uri.fail("first", value, "left or right: the eye that is the left or upper half of the frame");
        }
        request.right_first = value == "right";
    } else {
        uri.fail("parameter", parameter.key,
                 "serial, device, port, left, right, within_ms, format, force, layout or first");
    }
}

/// Returns what a path leads to, without the number of one of the nodes that a device has.
std::string device_of(const std::string& path) {
    std::error_code error;
    const std::string whole = std::filesystem::weakly_canonical(path, error).string();
    const std::string& text = error ? path : whole;
    const auto index = text.rfind("-video-index");
    return text.starts_with("/dev/v4l/by-") && index != std::string::npos ? text.substr(0, index) : text;
}

/// Whether two names mean one camera, whichever cameras are there. A link of udev by-id ends with the serial number.
bool is_one_device(const CameraName& one, const CameraName& other) {
    const auto by_id = [](const CameraName& name, const CameraName& link) {
        return !name.serial.empty() && link.device.starts_with("/dev/v4l/by-id/") &&
               link.device.find("_" + name.serial + "-video-index") != std::string::npos;
    };
    return one == other || by_id(one, other) || by_id(other, one) ||
           (!one.device.empty() && !other.device.empty() && device_of(one.device) == device_of(other.device));
}

/// Reads what makes two cameras one source, and refuses what has no meaning then.
void read_pair(const SourceUri& uri, CameraRequest& request) {
    std::optional<CameraName> left;
    std::string_view within;
    for (const SourceUri::Parameter& parameter : uri.parameters()) {
        if (parameter.key == "left" || parameter.key == "right") {
            const CameraName name = eye_name(std::string(parameter.value));
            if (name == CameraName{}) {
                uri.fail(std::string(parameter.key), parameter.value, "a node, port:USB-PORT or serial:NUMBER");
            }
            (parameter.key == "left" ? left : request.right) = name;
        }
        within = parameter.key == "within_ms" ? parameter.value : within;
    }
    if (left.has_value() != request.right.has_value()) {
        uri.fail("parameter", left ? "left= alone" : "right= alone", "left= and right=: a camera for each eye");
    }
    if (!left) {
        if (!within.empty()) {
            uri.fail("parameter", "within_ms", "within_ms= beside left= and right=");
        }
        return;
    }
    if (is_one_device(*left, *request.right)) {
        uri.fail("left and right", left->text().substr(1),
                 "two cameras; those with one serial number are told apart by port: or by node");
    }
    const CameraName& other = request;
    if (other != CameraName{} || request.sent->interleaved() || request.top_bottom || request.right_first) {
        uri.fail("parameter",
                 "left= and right= with device=, serial=, port=, layout=, first= or an interleaved format=",
                 "left= and right=, where each camera sends one eye, or one camera of both eyes");
    }
    if (!request.mode.empty()) {
        uri.fail("mode", uri.name(), "the size of each camera's frame, such as 640x480, beside left= and right=");
    }
    // Farther apart than half of the interval, another frame is nearer.
    const double half_ms = std::floor(500'000 / request.rate) / 1000;
    request.within_ns =
        std::llround(1e6 * (within.empty() ? half_ms : uri.number("within_ms", within, 0.001, half_ms)));
    static_cast<CameraName&>(request) = *left;
}

void check_size(const SourceUri& uri, const CameraRequest& request) {
    const std::string size = std::to_string(request.frame_width) + "x" + std::to_string(request.frame_height);
    const int pixels = request.format() == PixelFormat::grey8 ? 1 : 2;  // of Bayer, so that both eyes begin alike
    if (request.sent->interleaved() && request.top_bottom) {
        uri.fail("layout", "top-bottom", "side-by-side with a format whose pixels have values of both eyes");
    }
    if (request.sent->interleaved()) {
        return;
    }
    if (request.right && request.frame_width % (2 * pixels) != 0) {
        uri.fail("size", size, "a width that is a multiple of " + std::to_string(2 * pixels) + " for this format");
    }
    if (request.top_bottom && (request.frame_height % (request.sent->packing == Packing::bayer ? 4 : 2) != 0 ||
                               request.frame_width % pixels != 0)) {
        uri.fail("size", size, "an even height with layout=top-bottom, and an even width for this format");
    }
    if (!request.top_bottom && request.frame_width % (2 * pixels) != 0) {
        uri.fail("size", size,
                 "a width that two eyes can share: a multiple of " + std::to_string(2 * pixels) + " for this format");
    }
}

bool same_node(const std::string& node, const std::string& device) {
    std::error_code error;
    return !node.empty() && (node == device || std::filesystem::canonical(device, error).string() == node);
}

}  // namespace

std::string CameraName::text() const {
    std::string text = serial.empty() ? "" : " with serial " + serial;
    text += device.empty() ? "" : " " + device;
    text += port.empty() ? "" : " at USB port " + port;
    return text;
}

std::string CameraRequest::wanted() const {
    if (right) {
        return "cameras" + text() + " (left) and" + right->text() + " (right)";
    }
    return (zed_only() ? "ZED camera" : "camera") + text();
}

CameraRequest request_of_eye(const CameraRequest& pair, Eye eye) {
    CameraRequest request = pair;
    if (eye == Eye::right) {
        static_cast<CameraName&>(request) = *pair.right;
    }
    request.right.reset();
    request.half_of_pair = true;
    return request;
}

bool is_camera(const std::string& uri) {
    return uri.starts_with(scheme);
}

CameraRequest parse_camera_uri(const std::string& text) {
    const SourceUri uri(text);
    CameraRequest request;
    read_mode(uri, request);
    if (uri.has_rate()) {
        const auto number = base::parse_number(uri.rate());
        if (!number || *number < 1 || *number > 1000) {
            uri.fail("rate", uri.rate(), "1 to 1000 frames per second");
        }
        request.rate = *number;
    }
    for (const SourceUri::Parameter& parameter : uri.parameters()) {
        read_parameter(uri, parameter, request);
    }
    read_pair(uri, request);
    check_size(uri, request);
    return request;
}

std::vector<UsbCamera> candidates(const std::vector<UsbCamera>& cameras, const CameraRequest& request) {
    std::vector<UsbCamera> list;
    std::copy_if(cameras.begin(), cameras.end(), std::back_inserter(list), [&](const UsbCamera& camera) {
        return (request.device.empty() || same_node(camera.node, request.device)) &&
               (request.port.empty() || camera.port == request.port) &&
               (!request.zed_only() || camera.zed() != nullptr);
    });
    // ZED cameras that can work come first.
    std::stable_partition(list.begin(), list.end(), [](const UsbCamera& camera) {
        return camera.zed() != nullptr && !camera.zed()->old_firmware && !camera.node.empty();
    });
    return list;
}

}  // namespace disparityd::capture
