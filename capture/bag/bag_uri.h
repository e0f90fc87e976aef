// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace disparityd::capture {

/// A bag and what of it is to be read: "PATH?left=/TOPIC&right=/TOPIC". What is not said is found.
struct BagUri {
    std::string path;   ///< a .mcap, .db3 or .bag file, or a folder with metadata.yaml
    std::string left;   ///< topic; with `right`, or empty
    std::string right;  ///< topic
    std::string both;   ///< topic whose images have both eyes side by side
    std::string imu;    ///< topic; "off": none is read
    std::optional<bool> rectified;
    std::int64_t within_ns = 5'000'000;  ///< stamps of a pair are at most so far apart
    int bits = 0;                        ///< of values in images of 16 bits; 0: 16
};

/// Whether the path in front of "?" is that of a bag: by the ending of a file, by what a folder holds.
bool is_bag(const std::string& uri);

/// Throws std::invalid_argument with one line for parameters that are not allowed.
BagUri parse_bag_uri(const std::string& uri);

}  // namespace disparityd::capture
