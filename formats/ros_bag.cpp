// SPDX-License-Identifier: Apache-2.0
#include "formats/ros_bag.h"

#include <array>
#include <filesystem>
#include <fstream>

#include "base/words.h"
#include "formats/mcap_bag.h"
#include "formats/ros1_bag.h"
#include "formats/sqlite_bag.h"

namespace disparityd::formats {

std::unique_ptr<RosBag> open_ros_bag(const std::string& path) {
    std::array<char, 8> bytes{};
    std::ifstream file(path, std::ios::binary);
    file.read(bytes.data(), bytes.size());
    const std::string_view begin(bytes.data(), bytes.size());
    const std::string ending = base::lower_case(std::filesystem::path(path).extension().string());
    if (begin == "SQLite f" || (begin != mcap_magic && ending == ".db3")) {
        return std::make_unique<SqliteBag>(path);
    }
    if (begin == "#ROSBAG " || (begin != mcap_magic && ending == ".bag")) {
        return std::make_unique<Ros1Bag>(path);
    }
    return std::make_unique<McapBag>(path);
}

}  // namespace disparityd::formats
