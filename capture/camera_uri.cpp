// SPDX-License-Identifier: Apache-2.0
#include "capture/camera_uri.h"

#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include "capture/text_file.h"
#include "capture/zed_modes.h"

namespace disparityd::capture {

namespace {

constexpr std::string_view scheme = "v4l2:";

[[noreturn]] void refuse(const std::string& uri, const std::string& what, std::string_view found,
                         const std::string& allowed) {
    throw std::invalid_argument("source " + uri + ": " + what + ": found '" + std::string(found) + "', allowed is " +
                                allowed);
}

int size_number(const std::string& uri, std::string_view text) {
    const auto number = parse_number(text);
    if (!number || *number != static_cast<int>(*number) || *number < 16 || *number > 16384) {
        refuse(uri, "size of the whole frame", text, "WIDTHxHEIGHT, each 16 to 16384");
    }
    return static_cast<int>(*number);
}

void read_mode(const std::string& uri, std::string_view text, CameraRequest& request) {
    const std::string name = text.empty() ? "hd720" : lower_case(text);
    const auto* mode =
        std::find_if(zed_modes.begin(), zed_modes.end(), [&](const ZedMode& m) { return m.name == name; });
    if (mode != zed_modes.end()) {
        request.mode = name;
        request.frame_width = 2 * mode->width;
        request.frame_height = mode->height;
        request.rate = std::min(30, mode->highest_rate);
        return;
    }
    const auto cross = name.find('x');
    if (cross == std::string::npos) {
        refuse(uri, "mode", text, "hd2k, hd1080, hd720, vga, or the size of the whole frame such as 2560x720");
    }
    request.frame_width = size_number(uri, std::string_view(name).substr(0, cross));
    request.frame_height = size_number(uri, std::string_view(name).substr(cross + 1));
}

void read_parameter(const std::string& uri, std::string_view parameter, CameraRequest& request) {
    const auto equals = parameter.find('=');
    const std::string_view key = parameter.substr(0, equals);
    const std::string value(equals == std::string_view::npos ? "" : parameter.substr(equals + 1));
    if (value.empty()) {
        refuse(uri, "parameter", parameter, "serial=, device=, port=, format= or layout= with a value");
    }
    if (key == "serial") {
        request.serial = value;
    } else if (key == "device") {
        request.device = value;
    } else if (key == "port") {
        request.port = value;
    } else if (key == "format") {
        if (value != "yuyv" && value != "grey") {
            refuse(uri, "format", value, "yuyv or grey");
        }
        request.format = value == "grey" ? PixelFormat::grey8 : PixelFormat::yuyv;
    } else if (key == "layout") {
        if (value != "side-by-side" && value != "top-bottom") {
            refuse(uri, "layout", value, "side-by-side or top-bottom");
        }
        request.top_bottom = value == "top-bottom";
    } else {
        refuse(uri, "parameter", key, "serial, device, port, format or layout");
    }
}

void check_size(const std::string& uri, const CameraRequest& request) {
    const std::string size = std::to_string(request.frame_width) + "x" + std::to_string(request.frame_height);
    const int pixels = request.format == PixelFormat::yuyv ? 2 : 1;
    if (request.top_bottom && (request.frame_height % 2 != 0 || request.frame_width % pixels != 0)) {
        refuse(uri, "size", size, "an even height with layout=top-bottom, and an even width for YUYV");
    }
    if (!request.top_bottom && request.frame_width % (2 * pixels) != 0) {
        refuse(uri, "size", size,
               "a width that two eyes can share: a multiple of " + std::to_string(2 * pixels) + " for this format");
    }
}

bool same_node(const std::string& node, const std::string& device) {
    std::error_code error;
    return !node.empty() && (node == device || std::filesystem::canonical(device, error).string() == node);
}

}  // namespace

std::string CameraRequest::wanted() const {
    const bool zed = !mode.empty() && device.empty() && port.empty();
    std::string text = zed ? "ZED camera" : "camera";
    text += serial.empty() ? "" : " with serial " + serial;
    text += device.empty() ? "" : " " + device;
    text += port.empty() ? "" : " at USB port " + port;
    return text;
}

bool is_camera(const std::string& uri) {
    return uri.starts_with(scheme);
}

CameraRequest parse_camera_uri(const std::string& uri) {
    std::string_view rest = std::string_view(uri).substr(scheme.size());
    std::string_view parameters;
    if (const auto question = rest.find('?'); question != std::string_view::npos) {
        parameters = rest.substr(question + 1);
        rest = rest.substr(0, question);
    }
    std::string_view rate;
    if (const auto at = rest.find('@'); at != std::string_view::npos) {
        rate = rest.substr(at + 1);
        rest = rest.substr(0, at);
    }
    CameraRequest request;
    read_mode(uri, rest, request);
    if (rate.data() != nullptr) {
        const auto number = parse_number(rate);
        if (!number || *number < 1 || *number > 1000) {
            refuse(uri, "rate", rate, "1 to 1000 frames per second");
        }
        request.rate = *number;
    }
    if (!parameters.empty()) {
        for (const std::string_view parameter : split(parameters, '&')) {
            read_parameter(uri, parameter, request);
        }
    }
    check_size(uri, request);
    return request;
}

std::vector<UsbCamera> candidates(const std::vector<UsbCamera>& cameras, const CameraRequest& request) {
    std::vector<UsbCamera> list;
    // A mode of ZED cameras means one of those: not whatever else has this size while the ZED is unplugged.
    const bool zed_only = !request.mode.empty() && request.device.empty() && request.port.empty();
    std::copy_if(cameras.begin(), cameras.end(), std::back_inserter(list), [&](const UsbCamera& camera) {
        return (request.device.empty() || same_node(camera.node, request.device)) &&
               (request.port.empty() || camera.port == request.port) && (!zed_only || camera.zed() != nullptr);
    });
    // A camera that works comes before one that cannot.
    std::stable_partition(list.begin(), list.end(), [](const UsbCamera& camera) {
        return camera.zed() != nullptr && !camera.zed()->old_firmware && !camera.node.empty();
    });
    return list;
}

}  // namespace disparityd::capture
