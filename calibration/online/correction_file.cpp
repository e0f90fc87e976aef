// SPDX-License-Identifier: Apache-2.0
#include "calibration/online/correction_file.h"

#include <cerrno>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "base/failure_text.h"
#include "base/message_text.h"
#include "base/text_file.h"
#include "base/words.h"
#include "calibration/calibration_identity.h"

namespace disparityd::calibration {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view title = "disparityd-correction 1";

std::string identity(const StereoCalibration& calibration) {
    return calibration_identity(to_text(calibration));
}

/// Keeps the characters that every file system takes.
std::string harmless(std::string name) {
    for (char& letter : name) {
        const bool good = (letter >= '0' && letter <= '9') || (letter >= 'a' && letter <= 'z') ||
                          (letter >= 'A' && letter <= 'Z') || letter == '-';
        letter = good ? letter : '_';
    }
    return name;
}

std::pair<const char*, std::int32_t CalibrationCorrection::*> const fields[] = {
    {"pitch_nrad", &CalibrationCorrection::pitch_nrad},
    {"yaw_nrad", &CalibrationCorrection::yaw_nrad},
    {"roll_nrad", &CalibrationCorrection::roll_nrad},
    {"focal_ppb", &CalibrationCorrection::focal_ppb}};

[[noreturn]] void refuse(const std::string& path, const std::string& what) {
    throw std::invalid_argument("correction " + path + ": " + what + "; delete the file, and a new one will be made");
}

/// Returns the text behind "key = ", or nothing.
std::optional<std::string> value_of(const std::string& text, const std::string& key) {
    for (const std::string_view line : base::split(text, '\n')) {
        const auto equals = line.find('=');
        if (equals != std::string_view::npos && base::trim(line.substr(0, equals)) == key) {
            return std::string(base::trim(line.substr(equals + 1)));
        }
    }
    return std::nullopt;
}

}  // namespace

std::string correction_path(const std::string& folder, const std::string& serial, int eye_width, int height,
                            const StereoCalibration& calibration) {
    const std::string camera = serial.empty() ? identity(calibration) : harmless(serial);
    return folder + "/self-calibration-" + camera + '-' + std::to_string(eye_width) + 'x' + std::to_string(height) +
           ".txt";
}

void write_correction(const std::string& path, const StereoCalibration& calibration,
                      const CalibrationCorrection& correction) {
    const std::string unfinished = path + ".new";
    std::ofstream file(unfinished, std::ios::binary | std::ios::trunc);
    file << title << "\ncalibration = " << identity(calibration) << '\n';
    for (const auto& [key, field] : fields) {
        file << key << " = " << correction.*field << '\n';
    }
    file.close();
    const int reason = errno;
    if (!file) {
        throw std::runtime_error("correction " + unfinished + ": cannot be written: " + base::error_text(reason));
    }
    std::error_code error;
    fs::rename(unfinished, path, error);
    if (error) {
        throw std::runtime_error("correction " + path + ": cannot be written: " + base::error_text(error.value()));
    }
}

std::optional<CalibrationCorrection> read_correction(const std::string& path, const StereoCalibration& calibration) {
    std::error_code error;
    if (!fs::exists(path, error)) {
        return std::nullopt;
    }
    const std::string text = base::read_text_file(path, "correction");
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
    CalibrationCorrection correction;
    for (const auto& [key, field] : fields) {
        const std::string found = value_of(text, key).value_or("");
        const auto [end, problem] = std::from_chars(found.data(), found.data() + found.size(), correction.*field);
        if (problem != std::errc() || end != found.data() + found.size()) {
            refuse(path, std::string(key) + ": found '" + base::printable(found) + "', expected a whole number");
        }
    }
    if (!is_plausible(correction)) {
        refuse(path, "two cameras do not turn by more than 3 degrees against each other");
    }
    return correction;
}

}  // namespace disparityd::calibration
