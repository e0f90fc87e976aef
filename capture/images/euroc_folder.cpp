// SPDX-License-Identifier: Apache-2.0
#include "capture/images/euroc_folder.h"

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "base/failure_text.h"
#include "base/file_kind.h"
#include "base/message_text.h"
#include "base/text_file.h"
#include "base/words.h"
#include "capture/images/folder_pair.h"
#include "capture/images/image_times.h"

namespace disparityd::capture {
namespace {

namespace fs = std::filesystem;

/// Names of images by their times.
using Images = std::map<std::int64_t, std::string>;

/// Reads data.csv of one camera.
Images read_images(const fs::path& path) {
    constexpr std::uintmax_t most_bytes = 64U << 20U;  // a day of 20 images a second
    std::error_code error;
    if (const auto size = fs::file_size(path, error); !error && size > most_bytes) {
        throw std::invalid_argument(path.string() + ": found " + std::to_string(size) + " bytes, allowed are 64 MiB");
    }
    std::ifstream file(path);
    if (!file) {
        throw std::invalid_argument(path.string() + ": cannot be read: " + base::error_text(errno));
    }
    Images images;
    std::string text;
    for (int number = 1; std::getline(file, text); ++number) {
        std::string_view line = base::trim(number == 1 ? base::without_byte_order_mark(text) : std::string_view(text));
        if (line.empty() || line.front() == '#') {
            continue;
        }
        const std::string where = path.string() + ":" + std::to_string(number) + ": ";
        const std::string shown = base::printable(line);
        const auto time = take_time(line);
        const std::string name(base::trim(line));
        if (!time || name.empty() || name.find('/') != std::string::npos || name.find('\0') != std::string::npos) {
            throw std::invalid_argument(where + "found '" + shown +
                                        "', expected the time in ns, a comma and the name of an image");
        }
        if (!images.empty() && *time <= images.rbegin()->first) {
            throw std::invalid_argument(where + "found the time " + std::to_string(*time) + ", expected more than " +
                                        std::to_string(images.rbegin()->first) + ", the one above it");
        }
        images.emplace_hint(images.end(), *time, name);
    }
    return images;
}

/// Puts the files of the cameras, with commas between them, and that of the sensor, where it is there, into the
/// sequence. False unless all cameras have theirs.
bool take_calibration(ImageSequence& sequence, const std::vector<fs::path>& cameras, const fs::path& sensor) {
    if (!std::all_of(cameras.begin(), cameras.end(), [](const fs::path& file) { return base::is_file(file); })) {
        return false;
    }
    for (const fs::path& file : cameras) {
        sequence.calibration += (sequence.calibration.empty() ? "" : ",") + file.string();
    }
    sequence.inertial_calibration = base::is_file(sensor) ? sensor.string() : "";
    return true;
}

void find_calibration(ImageSequence& sequence, const fs::path& root) {
    if (!take_calibration(sequence, {root / "cam0" / "sensor.yaml", root / "cam1" / "sensor.yaml"},
                          root / "imu0" / "sensor.yaml")) {
        const fs::path dso = fs::absolute(root).lexically_normal().parent_path() / "dso";
        take_calibration(sequence, {dso / "camchain.yaml"}, dso / "imu_config.yaml");
    }
}

/// One eye: what data.csv lists, and what is there.
struct Eye {
    fs::path folder;
    Images listed;
    std::set<std::string> present;

    explicit Eye(const fs::path& camera) : folder(camera / "data"), listed(read_images(camera / "data.csv")) {
        const auto names = image_names(folder.string());
        present.insert(names.begin(), names.end());
    }
    /// Returns the image of a time; empty where there is none.
    std::string at(std::int64_t time) const {
        const auto found = listed.find(time);
        return found != listed.end() && present.contains(found->second) ? (folder / found->second).string()
                                                                        : std::string();
    }
};

}  // namespace

std::optional<ImageSequence> find_euroc(const std::string& folder) {
    fs::path root = fs::path(folder) / "mav0";
    const auto fits = [&root] {
        return base::is_file(root / "cam0" / "data.csv") && base::is_file(root / "cam1" / "data.csv") &&
               base::is_folder(root / "cam0" / "data") && base::is_folder(root / "cam1" / "data");
    };
    if (!fits()) {
        root = folder;
        if (!fits()) {
            return std::nullopt;
        }
    }
    const Eye left(root / "cam0");
    const Eye right(root / "cam1");
    std::set<std::int64_t> times;
    for (const Eye* eye : {&left, &right}) {
        for (const auto& [time, name] : eye->listed) {
            times.insert(time);
        }
    }
    ImageSequence sequence;
    sequence.description = "EuRoC cam0/cam1";
    find_calibration(sequence, root);
    sequence.timed = true;
    if (const fs::path samples = root / "imu0" / "data.csv"; base::is_file(samples)) {
        sequence.inertial_list = samples.string();
    }
    std::size_t alone[2] = {0, 0}, missing = 0;
    for (const std::int64_t time : times) {
        std::string first = left.at(time), second = right.at(time);
        if (!first.empty() && !second.empty()) {
            sequence.frames.push_back({std::move(first), std::move(second), time, {}});
        } else if (first.empty() && second.empty()) {
            ++missing;
        } else {
            ++alone[first.empty() ? 1 : 0];
        }
    }
    if (sequence.frames.empty()) {
        throw std::invalid_argument(root.string() +
                                    ": found no two images with the same time in cam0/data.csv and cam1/data.csv that "
                                    "are both in the folders data");
    }
    if (alone[0] + alone[1] + missing != 0) {
        sequence.unpaired = root.string() + ": " + base::counted(sequence.frames.size(), "pair") + "; skipped are " +
                            base::counted(alone[0], "image") + " of the left eye alone, " + std::to_string(alone[1]) +
                            " of the right eye alone, and " + base::counted(missing, "time") + " without an image";
    }
    return sequence;
}

}  // namespace disparityd::capture
