// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/output_file.h"

#include <cerrno>
#include <filesystem>
#include <stdexcept>

#include <unistd.h>

#include "base/write_failure.h"

namespace disparityd::tools {

void check_writable(const std::string& path) {
    std::error_code error;
    if (std::filesystem::is_directory(path, error)) {
        throw std::invalid_argument(path + ": is a folder, allowed: the name of a file");
    }
    const std::string parent = std::filesystem::path(path).parent_path().string();
    const std::string folder = parent.empty() ? "." : parent;
    if (!std::filesystem::is_directory(folder, error)) {
        throw std::invalid_argument(path + ": the folder " + folder + " is not there; make it, or name another file");
    }
    if (!std::filesystem::exists(path, error) && ::access(folder.c_str(), W_OK) != 0) {
        base::refuse_to_write(path, errno);
    }
}

void check_absent(const std::string& path, bool force) {
    std::error_code error;
    if (!force && std::filesystem::exists(path, error)) {
        throw std::invalid_argument(path + ": exists already, allowed: a new file, or --force to replace it");
    }
}

void check_output(const std::string& path, bool force) {
    check_absent(path, force);
    check_writable(path);
}

}  // namespace disparityd::tools
