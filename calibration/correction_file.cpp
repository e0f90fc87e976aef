// SPDX-License-Identifier: Apache-2.0
#include "calibration/correction_file.h"

#include <cerrno>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "capture/message_text.h"
#include "capture/recording_format.h"
#include "capture/text_file.h"
#include "capture/words.h"

namespace disparityd::calibration {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view title = "disparityd-correction 1";

std::string identity(const capture::StereoCalibration& calibration) {
    return capture::recording::calibration_identity(capture::to_text(calibration));
}

/// Only what every file system takes.
std::string harmless(std::string name) {
    for (char& letter : name) {
        const bool good = (letter >= '0' && letter <= '9') || (letter >= 'a' && letter <= 'z') ||
                          (letter >= 'A' && letter <= 'Z') || letter == '-';
        letter = good ? letter : '_';
    }
    return name;
}

std::pair<const char*, std::int32_t capture::CalibrationCorrection::*> const fields[] = {
    {"pitch_nrad", &capture::CalibrationCorrection::pitch_nrad},
    {"yaw_nrad", &capture::CalibrationCorrection::yaw_nrad},
    {"roll_nrad", &capture::CalibrationCorrection::roll_nrad},
    {"focal_ppb", &capture::CalibrationCorrection::focal_ppb}};

[[noreturn]] void refuse(const std::string& path, const std::string& what) {
    throw std::invalid_argument("correction " + path + ": " + what + "; delete the file, and a new one will be made");
}

/// The text behind "key = ", or nothing.
std::optional<std::string> value_of(const std::string& text, const std::string& key) {
    for (const std::string_view line : capture::split(text, '\n')) {
        const auto equals = line.find('=');
        if (equals != std::string_view::npos && capture::trim(line.substr(0, equals)) == key) {
            return std::string(capture::trim(line.substr(equals + 1)));
        }
    }
    return std::nullopt;
}

}  // namespace

std::string correction_path(const std::string& folder, const capture::SourceInfo& source) {
    const std::string who = !source.serial.empty() ? harmless(source.serial)
                            : source.calibration   ? identity(*source.calibration)
                                                   : "unknown";
    return folder + "/self-calibration-" + who + '-' + std::to_string(source.eye_width) + 'x' +
           std::to_string(source.height) + ".txt";
}

void write_correction(const std::string& path, const capture::StereoCalibration& calibration,
                      const capture::CalibrationCorrection& correction) {
    const std::string unfinished = path + ".new";
    std::ofstream file(unfinished, std::ios::binary | std::ios::trunc);
    file << title << "\ncalibration = " << identity(calibration) << '\n';
    for (const auto& [key, field] : fields) {
        file << key << " = " << correction.*field << '\n';
    }
    file.close();
    const int reason = errno;
    if (!file) {
        throw std::runtime_error("correction " + unfinished +
                                 ": cannot be written: " + std::generic_category().message(reason));
    }
    std::error_code error;
    fs::rename(unfinished, path, error);
    if (error) {
        throw std::runtime_error("correction " + path + ": cannot be written: " + error.message());
    }
}

std::optional<capture::CalibrationCorrection> read_correction(const std::string& path,
                                                              const capture::StereoCalibration& calibration) {
    std::error_code error;
    if (!fs::exists(path, error)) {
        return std::nullopt;
    }
    const std::string text = capture::read_text_file(path, "correction");
    if (!text.starts_with(title)) {
        refuse(path, "does not begin with '" + std::string(title) + "'");
    }
    const auto corrects = value_of(text, "calibration");
    if (!corrects || corrects->size() != identity(calibration).size()) {
        refuse(path, "does not say which calibration it corrects");
    }
    if (*corrects != identity(calibration)) {
        return std::nullopt;
    }
    capture::CalibrationCorrection correction;
    for (const auto& [key, field] : fields) {
        const std::string found = value_of(text, key).value_or("");
        const auto [end, problem] = std::from_chars(found.data(), found.data() + found.size(), correction.*field);
        if (problem != std::errc() || end != found.data() + found.size()) {
            refuse(path, std::string(key) + ": found '" + capture::shown(found) + "', expected a whole number");
        }
    }
    if (!is_plausible(correction)) {
        refuse(path, "two cameras do not turn by more than 3 degrees against each other");
    }
    return correction;
}

}  // namespace disparityd::calibration
