// SPDX-License-Identifier: Apache-2.0
#include "tests/bridges/ros2/claimed_domain.h"

#include <filesystem>
#include <stdexcept>
#include <string>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

namespace disparityd::test {

ClaimedDomain::ClaimedDomain() {
    const std::string prefix = std::filesystem::temp_directory_path() / "disparityd-test-domain-";
    for (id_ = 101; id_ <= 160; ++id_) {
        // Somebody else's file, which no O_CREAT may open in a folder for all, can be locked as well.
        const std::string path = prefix + std::to_string(id_);
        fd_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
        fd_ = fd_ >= 0 ? fd_ : ::open(path.c_str(), O_RDONLY | O_CREAT | O_CLOEXEC, 0644);
        if (fd_ >= 0 && ::flock(fd_, LOCK_EX | LOCK_NB) == 0) {
            return;
        }
        ::close(fd_);
    }
    throw std::runtime_error(prefix + "101 .. 160: no file of these can be locked; remove them when no test runs");
}

ClaimedDomain::~ClaimedDomain() {
    ::close(fd_);
}

}  // namespace disparityd::test
