// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace disparityd::base {

/// Returns whether there is such a folder; false where the system does not let us look.
inline bool is_folder(const std::filesystem::path& path) {
    std::error_code ignored;
    return std::filesystem::is_directory(path, ignored);
}

/// Returns whether there is such a file; false where the system does not let us look.
inline bool is_file(const std::filesystem::path& path) {
    std::error_code ignored;
    return std::filesystem::is_regular_file(path, ignored);
}

}  // namespace disparityd::base
