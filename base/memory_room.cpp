// SPDX-License-Identifier: Apache-2.0
#include "base/memory_room.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <stdexcept>

namespace disparityd::base {
namespace {

/// Returns the number of a file that holds one; nothing where it is missing or holds a word, such as "max".
std::optional<std::uint64_t> number_in(const std::string& path) {
    std::ifstream file(path);
    std::uint64_t number = 0;
    return file >> number ? std::optional(number) : std::nullopt;
}

/// Returns the number behind a key at the begin of a line.
std::optional<std::uint64_t> number_of(const std::string& path, const std::string& key) {
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) {
        std::istringstream words(line);
        std::string found;
        std::uint64_t number = 0;
        if (words >> found >> number && found == key) {
            return number;
        }
    }
    return std::nullopt;
}

/// The files of a control group, which versions 1 and 2 name otherwise.
struct GroupFiles {
    const char* limit;
    const char* used;
    const char* cached;  ///< key in memory.stat: pages of files that are given up first, those of groups below included
};

constexpr GroupFiles version_1{"memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"};
constexpr GroupFiles version_2{"memory.max", "memory.current", "inactive_file"};

std::size_t room_in(const std::string& folder, const GroupFiles& files) {
    const auto limit = number_in(folder + "/" + files.limit);
    const auto used = number_in(folder + "/" + files.used);
    if (!limit || !used) {
        return SIZE_MAX;
    }
    const std::uint64_t cached = number_of(folder + "/memory.stat", files.cached).value_or(0);
    const std::uint64_t held = *used - std::min(*used, cached);
    return static_cast<std::size_t>(*limit - std::min(*limit, held));
}

/// Takes the least room of a group and of those that it lies in.
void look_at_groups(const std::string& mount, std::filesystem::path group, const GroupFiles& files, MemoryRoom& room) {
    while (true) {
        if (const std::size_t bytes = room_in(mount + group.string(), files); bytes < room.bytes) {
            room = {bytes, "control group " + group.string()};
        }
        if (!group.has_relative_path()) {
            return;
        }
        group = group.parent_path();
    }
}

}  // namespace

MemoryRoom memory_room(const std::string& root) {
    constexpr std::uint64_t kibibyte = 1024;
    MemoryRoom room;
    if (const auto available = number_of(root + "/proc/meminfo", "MemAvailable:")) {
        room = {static_cast<std::size_t>(*available * kibibyte), "this machine"};
    }
    // Each line is NUMBER:CONTROLLERS:GROUP; version 2 names no controllers.
    std::ifstream groups(root + "/proc/self/cgroup");
    for (std::string line; std::getline(groups, line);) {
        const auto first = line.find(':');
        const auto second = line.find(':', first + 1);
        if (first == std::string::npos || second == std::string::npos) {
            continue;
        }
        const std::string controllers = line.substr(first + 1, second - first - 1);
        const std::string group = line.substr(second + 1);
        if (controllers.empty()) {
            look_at_groups(root + "/sys/fs/cgroup", group, version_2, room);
        } else if (("," + controllers + ",").find(",memory,") != std::string::npos) {
            look_at_groups(root + "/sys/fs/cgroup/memory", group, version_1, room);
        }
    }
    return room;
}

void check_memory_room(std::size_t needed, const MemoryRoom& room) {
    if (room.bytes == SIZE_MAX || needed <= room.bytes - std::min(room.bytes, memory_reserve)) {
        return;
    }
    const auto megabytes = [](std::size_t bytes) { return std::to_string(bytes / 1'000'000) + " MB"; };
    throw std::runtime_error("matching needs " + megabytes(needed) + " of memory more, and " +
                             megabytes(memory_reserve) + " are kept for all else, but " + room.where + " has " +
                             megabytes(room.bytes) +
                             " left: choose a smaller image, fewer disparities, fewer slots or the back end cpu");
}

std::size_t resident_memory() {
    constexpr std::uint64_t kibibyte = 1024;
    return static_cast<std::size_t>(number_of("/proc/self/status", "VmRSS:").value_or(0) * kibibyte);
}

}  // namespace disparityd::base
