// SPDX-License-Identifier: Apache-2.0
#include "tools/datasets/announced_range.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "base/file_kind.h"
#include "base/message_text.h"
#include "base/number_text.h"
#include "base/text_file.h"
#include "base/words.h"
#include "capture/images/image_sequence.h"
#include "tools/datasets/dataset.h"

namespace disparityd::datasets {
namespace {

/// The largest known disparity of the scenes in this folder; 0 where none has ground truth that can be read.
double largest_truth(const std::string& folder) {
    double largest = 0;
    for (const DatasetScene& scene : scenes_in(folder)) {
        try {
            for (const float disparity : read_ground_truth(scene).disparity) {
                largest = std::isfinite(disparity) ? std::max(largest, static_cast<double>(disparity)) : largest;
            }
        } catch (const std::invalid_argument&) {
            continue;  // of unknown scale, for example: it says nothing
        }
    }
    return largest;
}

}  // namespace

std::optional<AnnouncedRange> range_of_calibration(const std::string& path) {
    std::optional<AnnouncedRange> announced;
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) {
        const std::string_view text = base::without_byte_order_mark(line);
        const auto equals = std::min(text.find('='), text.size());
        const std::string key(base::trim(text.substr(0, equals)));
        if (equals == text.size() || (key != "ndisp" && key != "vmax")) {
            continue;
        }
        constexpr double most = 65535;
        const std::string_view word = base::trim(text.substr(equals + 1));
        const auto value = base::parse_number(word);
        const bool usable = value && *value >= 1 && *value <= most;
        if (!usable && key == "ndisp") {
            throw std::invalid_argument(path + ": ndisp: found '" + base::printable(word) +
                                        "', expected 1 to 65535: take the line out if the range is not known");
        }
        const double largest = usable ? *value - (key == "ndisp" ? 1 : 0) : 0;
        if (usable && (!announced || largest > announced->largest)) {
            announced = {largest, path + " says " + key + "=" + base::number_text(*value)};
        }
    }
    return announced;
}

std::optional<AnnouncedRange> range_of_images(const std::string& uri) {
    namespace fs = std::filesystem;
    if (!capture::is_image_sequence(uri)) {
        return std::nullopt;
    }
    const std::string path = capture::parse_image_uri(uri).path;
    const fs::path left = capture::find_images(path).frames.front().left;
    auto announced = range_of_calibration((left.parent_path() / "calib.txt").string());
    if (base::is_folder(path)) {
        const double largest = largest_truth(path);
        if (largest > (announced ? announced->largest : 0)) {
            announced = {largest,
                         "the ground truth of " + path + " reaches " + base::number_text(std::ceil(largest)) + " px"};
        }
    }
    return announced;
}

}  // namespace disparityd::datasets
