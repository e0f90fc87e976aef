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
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) {
        const std::string_view text = base::without_byte_order_mark(line);
        const auto equals = text.find('=');
        if (equals == std::string_view::npos || base::trim(text.substr(0, equals)) != "ndisp") {
            continue;
        }
        const auto value = base::parse_number(base::trim(text.substr(equals + 1)));
        if (value && *value >= 1 && *value <= 65535) {
            return AnnouncedRange{*value - 1, path + " says ndisp=" + base::number_text(*value)};
        }
    }
    return std::nullopt;
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
