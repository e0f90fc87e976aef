// SPDX-License-Identifier: Apache-2.0
#include "base/file_lock.h"

#include <array>
#include <cerrno>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include <sys/file.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>

#include "base/message_text.h"

namespace disparityd::base {

std::string lock_holder(int descriptor) {
    struct stat file {};
    if (fstat(descriptor, &file) != 0) {
        return {};
    }
    // /proc/locks writes the device in hexadecimal, the inode in decimal.
    std::array<char, 64> place{};
    std::snprintf(place.data(), place.size(), "%02x:%02x:%llu", major(file.st_dev), minor(file.st_dev),
                  static_cast<unsigned long long>(file.st_ino));
    std::ifstream locks("/proc/locks");
    for (std::string line; std::getline(locks, line);) {
        std::istringstream words(line);
        std::string number, kind, how, access, process, where;
        words >> number >> kind >> how >> access >> process >> where;
        if (kind != "FLOCK" || where != place.data() || process.empty() || process == "0" || process[0] == '-') {
            continue;
        }
        std::string name;
        std::ifstream command("/proc/" + process + "/comm");
        std::getline(command, name);
        return " (process " + process + (name.empty() ? "" : ", " + printable(name)) + ")";
    }
    return {};
}

void lock_for_writing(int descriptor, const std::string& path) {
    if (flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
        throw std::runtime_error(path + ": another program is writing it at the moment" + lock_holder(descriptor) +
                                 "; wait for its end, or choose another name");
    }
}

}  // namespace disparityd::base
