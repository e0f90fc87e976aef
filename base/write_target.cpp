// SPDX-License-Identifier: Apache-2.0
#include "base/write_target.h"

#include <cerrno>
#include <filesystem>

#include <sys/stat.h>
#include <unistd.h>

#include "base/write_failure.h"

namespace disparityd::base {

WriteTarget write_target(const std::string& path) {
    namespace fs = std::filesystem;
    std::error_code error;
    const bool dangling = !fs::exists(path, error) && fs::is_symlink(path, error);
    const fs::path wanted = dangling ? fs::path(path).parent_path() / fs::read_symlink(path, error) : fs::path(path);
    WriteTarget target{wanted.string(), false, {}};
    struct stat file {};
    const bool there = ::stat(target.path.c_str(), &file) == 0;
    if (there && ::access(target.path.c_str(), W_OK) != 0) {
        refuse_to_write(path, errno);
    }
    target.special = there && !S_ISREG(file.st_mode);
    if (!target.special) {
        const fs::path real = fs::weakly_canonical(wanted, error);
        target.path = error ? target.path : real.string();
    }
    if (there && !target.special) {
        target.mode = file.st_mode & 07777U;
    }
    return target;
}

}  // namespace disparityd::base
