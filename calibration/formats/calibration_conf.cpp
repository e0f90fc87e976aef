// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <map>
#include <string>

#include <opencv2/core/matx.hpp>

#include "base/message_text.h"
#include "base/number_text.h"
#include "base/words.h"
#include "calibration/formats/calibration_formats.h"
#include "calibration/formats/lens_model.h"
#include "calibration/rotation.h"
#include "calibration/zed_modes.h"

namespace disparityd::calibration {

namespace {

struct Value {
    std::string text;
    int line = 0;
};

/// How the sections of a factory file end, for each size of an eye.
struct Mode {
    std::string_view section;
    int width;
    int height;
};

/// Modes of cameras that come as frames of another source: ZED X, ZED X One 4K.
constexpr std::array<Mode, 3> other_modes{{{"FHD1200", 1920, 1200}, {"SVGA", 960, 600}, {"4K", 3840, 2160}}};

std::vector<Mode> all_modes() {
    std::vector<Mode> modes;
    for (const ZedMode& mode : zed_modes) {
        modes.push_back({mode.section, mode.width, mode.height});
    }
    modes.insert(modes.end(), other_modes.begin(), other_modes.end());
    return modes;
}

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
            const std::string key = base::lower_case(base::trim(line.substr(0, equals)));
            if (!sections_[section]
                     .emplace(key, Value{std::string(base::trim(line.substr(equals + 1))), number})
                     .second) {
                fail(number, "found '" + base::printable(line) + "': [" + base::printable(upper(section)) +
                                 "] has this key twice; once is allowed: take the wrong one out");
            }
        }
    }

    bool has(const std::string& section) const { return sections_.contains(section); }

    double number(const std::string& section, const std::string& key) const {
        const Value* value = find(section, key);
        if (value == nullptr) {
            refuse_calibration(path_, "[" + upper(section) + "] has no key " + key + ": the file is not complete");
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
        for (const Mode& mode : all_modes()) {
            if (has("left_cam_" + base::lower_case(mode.section))) {
                list += (list.empty() ? "" : ", ") + std::to_string(mode.width) + "x" + std::to_string(mode.height);
            }
        }
        return list;
    }

    /// Refuses keys of a section that is used, unless one of `known` fits: the whole key, or its beginning where that
    /// ends with an underscore.
    void check_keys(const std::string& section, std::initializer_list<std::string_view> known) const {
        const auto keys = sections_.find(section);
        if (keys == sections_.end()) {
            return;
        }
        for (const auto& [key, value] : keys->second) {
            const bool fits = std::any_of(known.begin(), known.end(), [&key = key](std::string_view name) {
                return key == name || (name.ends_with('_') && key.starts_with(name));
            });
            if (!fits) {
                std::string allowed;
                for (const std::string_view name : known) {
                    allowed += (allowed.empty() ? "" : " ") + std::string(name) + (name.ends_with('_') ? "<mode>" : "");
                }
                fail(value.line, "[" + upper(section) + "] " + base::printable(key) + ": found '" +
                                     base::printable(value.text) +
                                     "', a key that is not known and would not be applied; allowed are " + allowed +
                                     ": take it out if it says nothing about the cameras");
            }
        }
    }

    /// Refuses sections about the lens that are not known.
    void check_sections() const {
        for (const auto& [section, keys] : sections_) {
            const bool lens = section.find("disto") != std::string::npos || section.find("fish") != std::string::npos ||
                              section.find("lens") != std::string::npos;
            if (lens && section != "left_disto" && section != "right_disto") {
                refuse_calibration(path_, "has the section [" + base::printable(upper(section)) +
                                              "], which is not known and would not be applied; allowed are "
                                              "[LEFT_DISTO] and [RIGHT_DISTO]");
            }
        }
    }

    static std::string upper(std::string text) {
        for (char& c : text) {
            c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
        }
        return text;
    }

private:
    [[noreturn]] void fail(int line, const std::string& what) const {
        refuse_calibration(path_ + ":" + std::to_string(line), what);
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

/// Reads the coefficients of one eye. They stand in the camera's section or, for all modes, in one of their own.
void read_distortion(CameraModel& model, const ConfFile& file, const std::string& path, const std::string& camera,
                     const std::string& disto) {
    constexpr std::array<const char*, 8> names{"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"};
    const auto any = [&](const std::string& section) {
        return std::any_of(names.begin(), names.end(), [&](const char* name) { return file.has(section, name); });
    };
    const std::string section = any(disto) ? disto : camera;
    const std::string shown = "[" + ConfFile::upper(section) + "]";
    std::vector<double> coefficients;
    for (const char* name : names) {
        const bool needed = name == std::string_view("k1") || name == std::string_view("k2");
        coefficients.push_back(needed ? file.number(section, name) : file.number_or(section, name, 0));
        if (section == disto && file.has(camera, name) && file.number(camera, name) != coefficients.back()) {
            refuse_calibration(path, shown + " " + name + ": found " + base::number_text(coefficients.back()) +
                                         ", and [" + ConfFile::upper(camera) + "] has " +
                                         base::number_text(file.number(camera, name)) +
                                         ": they contradict each other; take the wrong one out");
        }
    }
    if (file.has(section, "p1") != file.has(section, "p2")) {
        refuse_calibration(path, shown + " has one of p1 and p2: the file is not complete");
    }
    const bool zero = std::all_of(coefficients.begin(), coefficients.end(), [](double k) { return k == 0; });
    if (file.has(section, "k4") && !file.has(section, "p1") && !zero) {
        refuse_fisheye(path, shown, "k1 to k4 without p1 and p2");
    }
    set_lens(model, path, shown + " k1 k2 p1 p2 k3 k4 k5 k6", coefficients, LensModel::pinhole);
}

CameraModel read_camera(const ConfFile& file, const std::string& path, const std::string& section,
                        const std::string& disto) {
    file.check_keys(section, {"fx", "fy", "cx", "cy", "k1", "k2", "k3", "k4", "k5", "k6", "p1", "p2"});
    file.check_keys(disto, {"k1", "k2", "k3", "k4", "k5", "k6", "p1", "p2"});
    CameraModel camera;
    camera.fx = file.number(section, "fx");
    camera.fy = file.number(section, "fy");
    camera.cx = file.number(section, "cx");
    camera.cy = file.number(section, "cy");
    read_distortion(camera, file, path, section, disto);
    return camera;
}

}  // namespace

StereoCalibration read_factory_conf(const std::string& path, const std::string& text, int width, int height) {
    const ConfFile file(path, text);
    const std::vector<Mode> modes = all_modes();
    const auto mode =
        std::find_if(modes.begin(), modes.end(), [&](const Mode& m) { return m.width == width && m.height == height; });
    const std::string suffix = mode != modes.end() ? base::lower_case(mode->section) : "";
    if (mode == modes.end() || !file.has("left_cam_" + suffix) || !file.has("right_cam_" + suffix)) {
        const std::string present = file.modes_present();
        if (present.empty()) {
            refuse_calibration(path,
                               "has no sections [LEFT_CAM_<mode>] and [RIGHT_CAM_<mode>] of a mode that is known; "
                               "those for " +
                                   base::size_text(width, height) + " are needed" +
                                   (mode != modes.end() ? ": <mode> " + std::string(mode->section) : ""));
        }
        refuse_other_size(path, present, width, height);
    }
    file.check_sections();
    // A key without a mode holds for all of them; those of other modes are not used.
    file.check_keys("stereo", {"baseline", "ty", "tz", "rx", "cv", "rz", "ty_", "tz_", "rx_", "cv_", "rz_", "simu"});
    StereoCalibration calibration;
    calibration.width = width;
    calibration.height = height;
    calibration.origin = path;
    calibration.left = read_camera(file, path, "left_cam_" + suffix, "left_disto");
    calibration.right = read_camera(file, path, "right_cam_" + suffix, "right_disto");

    const auto offset = [&](const std::string& key) {
        return file.has("stereo", key + "_" + suffix) ? file.number("stereo", key + "_" + suffix)
                                                      : file.number_or("stereo", key, 0);
    };
    // An angle that is given for all modes counts only where the mode has none of its own.
    const auto angle = [&](const std::string& key) {
        const bool general = !file.has("stereo", key + "_" + suffix) && file.has("stereo", key);
        return file.number("stereo", general ? key : key + "_" + suffix);
    };
    calibration.translation = {-file.number("stereo", "baseline"), offset("ty"), offset("tz")};
    const cv::Matx33d rotation = rotation_about({angle("rx"), angle("cv"), angle("rz")});
    std::copy(rotation.val, rotation.val + 9, calibration.rotation.begin());
    return calibration;
}

}  // namespace disparityd::calibration
