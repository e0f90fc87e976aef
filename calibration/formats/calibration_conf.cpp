// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <map>
#include <stdexcept>
#include <string>

#include <opencv2/calib3d.hpp>

#include "base/message_text.h"
#include "base/number_text.h"
#include "base/words.h"
#include "calibration/formats/calibration_formats.h"
#include "calibration/zed_modes.h"

namespace disparityd::calibration {

namespace {

struct Value {
    std::string text;
    int line = 0;
};

// Holds sections and keys in lower case: the vendor's reader ignores the case, too.
class ConfFile {
public:
    ConfFile(const std::string& path, const std::string& text) : path_(path) {
        std::string section;
        int number = 0;
        for (const std::string_view raw : base::split(text, '\n')) {
            ++number;
            const std::string_view line = base::trim(raw);
            if (line.empty() || line[0] == '#' || line[0] == ';') {
                continue;
            }
            if (line[0] == '[') {
                if (line.back() != ']') {
                    fail(number, "found '" + base::printable(line) + "', expected a section such as [LEFT_CAM_HD]");
                }
                section = base::lower_case(base::trim(line.substr(1, line.size() - 2)));
                sections_[section];
                continue;
            }
            const auto equals = line.find('=');
            if (equals == std::string_view::npos || section.empty()) {
                fail(number, "found '" + base::printable(line) +
                                 "', expected key=value within a section: this is no factory calibration");
            }
            sections_[section][base::lower_case(base::trim(line.substr(0, equals)))] = {
                std::string(base::trim(line.substr(equals + 1))), number};
        }
    }

    bool has(const std::string& section) const { return sections_.contains(section); }

    double number(const std::string& section, const std::string& key) const {
        const Value* value = find(section, key);
        if (value == nullptr) {
            throw std::invalid_argument("calibration " + path_ + ": [" + upper(section) + "] has no key " + key +
                                        ": the file is not complete");
        }
        return number(section, key, *value);
    }

    double number_or(const std::string& section, const std::string& key, double otherwise) const {
        const Value* value = find(section, key);
        return value == nullptr ? otherwise : number(section, key, *value);
    }

    bool has(const std::string& section, const std::string& key) const { return find(section, key) != nullptr; }

    std::string modes_present() const {
        std::string list;
        for (const ZedMode& mode : zed_modes) {
            if (has("left_cam_" + base::lower_case(mode.section))) {
                list += (list.empty() ? "" : ", ") + std::to_string(mode.width) + "x" + std::to_string(mode.height);
            }
        }
        return list.empty() ? "none" : list;
    }

    static std::string upper(std::string text) {
        for (char& c : text) {
            c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
        }
        return text;
    }

private:
    [[noreturn]] void fail(int line, const std::string& what) const {
        throw std::invalid_argument("calibration " + path_ + ":" + std::to_string(line) + ": " + what);
    }

    const Value* find(const std::string& section, const std::string& key) const {
        const auto keys = sections_.find(section);
        if (keys == sections_.end()) {
            return nullptr;
        }
        const auto value = keys->second.find(key);
        return value == keys->second.end() ? nullptr : &value->second;
    }

    double number(const std::string& section, const std::string& key, const Value& value) const {
        const auto number = base::parse_number(value.text);
        if (!number) {
            const bool comma = value.text.find(',') != std::string::npos;
            fail(value.line, "[" + upper(section) + "] " + key + ": found '" + base::printable(value.text) +
                                 "', allowed is a number with a decimal point" +
                                 (comma ? " (the file was written under a locale with a decimal comma: fetch the "
                                          "original again)"
                                        : ""));
        }
        return *number;
    }

    std::string path_;
    std::map<std::string, std::map<std::string, Value>> sections_;
};

CameraModel read_camera(const ConfFile& file, const std::string& section) {
    CameraModel camera;
    camera.fx = file.number(section, "fx");
    camera.fy = file.number(section, "fy");
    camera.cx = file.number(section, "cx");
    camera.cy = file.number(section, "cy");
    camera.distortion = {file.number(section, "k1"), file.number(section, "k2"), file.number_or(section, "p1", 0),
                         file.number_or(section, "p2", 0), file.number_or(section, "k3", 0)};
    return camera;
}

}  // namespace

StereoCalibration read_factory_conf(const std::string& path, const std::string& text, int width, int height) {
    const ConfFile file(path, text);
    const ZedMode* mode = zed_mode_of_size(width, height);
    const std::string suffix = mode != nullptr ? base::lower_case(mode->section) : "";
    if (mode == nullptr || !file.has("left_cam_" + suffix) || !file.has("right_cam_" + suffix)) {
        refuse_other_size(path, file.modes_present(), width, height);
    }
    StereoCalibration calibration;
    calibration.width = width;
    calibration.height = height;
    calibration.origin = path;
    calibration.left = read_camera(file, "left_cam_" + suffix);
    calibration.right = read_camera(file, "right_cam_" + suffix);

    const auto offset = [&](const std::string& key) {
        return file.has("stereo", key + "_" + suffix) ? file.number("stereo", key + "_" + suffix)
                                                      : file.number_or("stereo", key, 0);
    };
    calibration.translation = {-file.number("stereo", "baseline"), offset("ty"), offset("tz")};
    const cv::Vec3d angles(file.number("stereo", "rx_" + suffix), file.number("stereo", "cv_" + suffix),
                           file.number("stereo", "rz_" + suffix));
    cv::Matx33d rotation;
    cv::Rodrigues(angles, rotation);
    std::copy(rotation.val, rotation.val + 9, calibration.rotation.begin());
    return calibration;
}

}  // namespace disparityd::calibration
