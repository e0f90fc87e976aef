// SPDX-License-Identifier: Apache-2.0
#include "capture/camera/camera_controls.h"

#include <algorithm>
#include <optional>
#include <stdexcept>

#include <linux/videodev2.h>

#include "base/failure_text.h"
#include "base/message_text.h"
#include "base/number_text.h"
#include "base/words.h"
#include "capture/camera/zed_controls.h"

namespace disparityd::capture {
namespace {

/// Returns the value of the last setting of this name, which is the one that the camera keeps.
std::optional<std::int64_t> value_in(const std::vector<CameraSetting>& settings, const std::string& name) {
    const auto found = std::find_if(settings.rbegin(), settings.rend(),
                                    [&name](const CameraSetting& setting) { return setting.name == name; });
    return found == settings.rend() ? std::nullopt : std::optional(found->value);
}

struct V4l2Control {
    CameraControl control;
    std::uint32_t id = 0;
};

/// Turns "White Balance Temperature" into "white-balance-temperature".
std::string plain_name(const unsigned char* text, std::size_t most) {
    std::string name;
    for (std::size_t i = 0; i < most && text[i] != 0; ++i) {
        const unsigned char c = text[i];
        const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
        if (letter) {
            name += static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
        } else if (!name.empty() && name.back() != '-') {
            name += '-';
        }
    }
    return !name.empty() && name.back() == '-' ? name.substr(0, name.size() - 1) : name;
}

bool is_number(const v4l2_queryctrl& query) {
    constexpr std::uint32_t useless = V4L2_CTRL_FLAG_DISABLED | V4L2_CTRL_FLAG_READ_ONLY | V4L2_CTRL_FLAG_WRITE_ONLY;
    return (query.flags & useless) == 0 && (query.type == V4L2_CTRL_TYPE_INTEGER ||
                                            query.type == V4L2_CTRL_TYPE_BOOLEAN || query.type == V4L2_CTRL_TYPE_MENU);
}

/// Opens a camera for as long as its controls are used.
class OpenCamera {
public:
    OpenCamera(VideoSystem& system, const UsbCamera& camera) : system_(system), device_(system.open(camera.node)) {
        if (device_ < 0) {
            throw std::runtime_error("camera: " + camera.node + " cannot be opened: " + base::error_text(-device_));
        }
    }
    ~OpenCamera() { system_.close(device_); }
    OpenCamera(const OpenCamera&) = delete;
    OpenCamera& operator=(const OpenCamera&) = delete;

    int device() const { return device_; }

    std::vector<V4l2Control> controls() {
        std::vector<V4l2Control> list;
        v4l2_queryctrl query{};
        query.id = V4L2_CTRL_FLAG_NEXT_CTRL;
        while (list.size() < 256 && system_.ioctl(device_, VIDIOC_QUERYCTRL, &query) == 0) {
            v4l2_control value{};
            value.id = query.id;
            if (is_number(query) && system_.ioctl(device_, VIDIOC_G_CTRL, &value) == 0) {
                list.push_back({{plain_name(query.name, sizeof query.name), value.value, query.minimum, query.maximum,
                                 query.default_value},
                                query.id});
            }
            query.id |= V4L2_CTRL_FLAG_NEXT_CTRL;
        }
        return list;
    }

    void set(const V4l2Control& control, std::int64_t value) {
        v4l2_control request{};
        request.id = control.id;
        request.value = static_cast<std::int32_t>(value);
        if (const int code = system_.ioctl(device_, VIDIOC_S_CTRL, &request); code != 0) {
            throw std::runtime_error("camera: " + control.control.name + " = " + std::to_string(value) +
                                     " is refused: " + base::error_text(code));
        }
    }

private:
    VideoSystem& system_;
    const int device_;
};

const V4l2Control* find(const std::vector<V4l2Control>& controls, const std::string& name) {
    const auto found = std::find_if(controls.begin(), controls.end(),
                                    [&name](const V4l2Control& c) { return c.control.name == name; });
    return found == controls.end() ? nullptr : &*found;
}

void check(const CameraSetting& setting, const std::vector<V4l2Control>& controls, bool zed) {
    const V4l2Control* known = find(controls, setting.name);
    if (known == nullptr) {
        std::string names = zed ? "auto-exposure, exposure-left, exposure-right, gain-left, gain-right" : "";
        for (const V4l2Control& control : controls) {
            names += (names.empty() ? "" : ", ") + control.control.name;
        }
        throw std::invalid_argument("camera: found '" + base::printable(setting.name) + "', allowed: " + names);
    }
    if (setting.value < known->control.min || setting.value > known->control.max) {
        throw std::invalid_argument("camera: " + setting.name + ": found " + std::to_string(setting.value) +
                                    ", allowed: " + std::to_string(known->control.min) + " .. " +
                                    std::to_string(known->control.max));
    }
}

}  // namespace

void ControlOverrides::note(const std::vector<CameraSetting>& settings, const std::vector<CameraSetting>& configured) {
    const std::lock_guard lock(mutex_);
    for (const CameraSetting& setting : settings) {
        std::erase_if(noted_, [&setting](const Noted& old) { return old.setting.name == setting.name; });
        noted_.push_back({setting, value_in(configured, setting.name)});
    }
}

std::vector<CameraSetting> ControlOverrides::in_force(const std::vector<CameraSetting>& configured) {
    const std::lock_guard lock(mutex_);
    std::erase_if(noted_, [&configured](const Noted& old) {
        const auto now = value_in(configured, old.setting.name);
        return now && now != old.configured;
    });
    std::vector<CameraSetting> settings;
    for (const Noted& noted : noted_) {
        settings.push_back(noted.setting);
    }
    return settings;
}

std::vector<CameraSetting> parse_camera_settings(const std::string& text, const std::string& where) {
    std::vector<CameraSetting> settings;
    for (const std::string_view word : base::split(text, ' ')) {
        if (word.empty()) {
            continue;
        }
        const auto equals = word.find('=');
        const auto value = base::parse_number(equals == std::string_view::npos ? "" : word.substr(equals + 1));
        constexpr double most = 1e9;
        if (equals == 0 || !value || *value < -most || *value > most ||
            *value != static_cast<double>(static_cast<std::int64_t>(*value))) {
            throw std::invalid_argument(where + ": found '" + base::printable(word) +
                                        "', allowed: NAME=NUMBER with spaces between, such as \"auto-exposure=0 "
                                        "gain-left=30\"");
        }
        settings.push_back({std::string(word.substr(0, equals)), static_cast<std::int64_t>(*value)});
    }
    return settings;
}

std::vector<CameraControl> control_camera(VideoSystem& system, const UsbCamera& camera, double rate,
                                          const std::vector<CameraSetting>& settings) {
    OpenCamera open(system, camera);
    std::optional<ZedUnit> unit;
    if (camera.zed() != nullptr) {
        try {
            unit.emplace(system, open.device());
        } catch (const ZedError&) {
            // A firmware without the unit still has the controls of V4L2.
        }
    }
    std::vector<V4l2Control> controls = open.controls();
    for (const CameraSetting& setting : settings) {
        if (!unit || !is_zed_control(setting, rate)) {
            check(setting, controls, unit.has_value());
        }
    }
    for (const CameraSetting& setting : settings) {
        if (unit && is_zed_control(setting, rate)) {
            set_zed_control(*unit, setting);
        } else {
            open.set(*find(controls, setting.name), setting.value);
        }
    }
    std::vector<CameraControl> list = unit ? read_zed_controls(*unit, rate) : std::vector<CameraControl>();
    for (const V4l2Control& control : open.controls()) {
        list.push_back(control.control);
    }
    return list;
}

}  // namespace disparityd::capture
