// SPDX-License-Identifier: Apache-2.0
#include "capture/bag/bag_uri.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "base/words.h"
#include "capture/source_uri.h"

namespace disparityd::capture {
namespace {

std::string path_of(const std::string& uri) {
    return uri.substr(0, uri.rfind('?'));
}

/// Whether a folder is that of a bag. Other folders of images have a metadata.yaml, too.
bool is_bag_folder(const std::filesystem::path& folder) {
    constexpr std::size_t enough = 4096;
    std::string begin(enough, '\0');
    std::ifstream file(folder / "metadata.yaml", std::ios::binary);
    file.read(begin.data(), static_cast<std::streamsize>(begin.size()));
    return begin.find("rosbag2_bagfile_information") != std::string::npos;
}

}  // namespace

bool is_bag(const std::string& uri) {
    const std::filesystem::path path(path_of(uri));
    const std::string ending = base::lower_case(path.extension().string());
    return ending == ".mcap" || ending == ".db3" || ending == ".bag" || is_bag_folder(path);
}

BagUri parse_bag_uri(const std::string& uri) {
    constexpr double most_ms = 1000;
    BagUri bag;
    bag.path = path_of(uri);
    const std::string behind = ":" + uri.substr(bag.path.size());  // a path may have what separates parts of other URIs
    const SourceUri parameters(behind);
    for (const SourceUri::Parameter& parameter : parameters.parameters()) {
        const std::string value(parameter.value);
        if (parameter.key == "left" && !value.empty()) {
            bag.left = value;
        } else if (parameter.key == "right" && !value.empty()) {
            bag.right = value;
        } else if (parameter.key == "both" && !value.empty()) {
            bag.both = value;
        } else if (parameter.key == "imu" && !value.empty()) {
            bag.imu = value;
        } else if (parameter.key == "rectified" && (value == "yes" || value == "no")) {
            bag.rectified = value == "yes";
        } else if (parameter.key == "within_ms") {
            bag.within_ns = std::llround(1e6 * parameters.number("within_ms", parameter.value, 0, most_ms));
        } else if (parameter.key == "bits") {
            bag.bits = parameters.integer("bits", parameter.value, 9, 16);
        } else {
            parameters.fail(
                "parameter", parameter.text,
                "left=/TOPIC, right=/TOPIC, both=/TOPIC (side by side), imu=/TOPIC or off, rectified=yes or "
                "no, within_ms=0 to 1000, bits=9 to 16");
        }
    }
    if (bag.left.empty() != bag.right.empty() || (!bag.left.empty() && !bag.both.empty())) {
        throw std::invalid_argument("source " + uri + ": name both topics, left=/TOPIC and right=/TOPIC, or one of " +
                                    "both eyes side by side, both=/TOPIC");
    }
    return bag;
}

}  // namespace disparityd::capture
