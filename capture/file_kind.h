// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace disparityd::capture {

/// Whether there is such a folder or file; what may not be looked at is none.
inline bool is_folder(const std::filesystem::path& path) {
    std::error_code ignored;
    return std::filesystem::is_directory(path, ignored);
}

inline bool is_file(const std::filesystem::path& path) {
    std::error_code ignored;
    return std::filesystem::is_regular_file(path, ignored);
}

}  // namespace disparityd::capture
