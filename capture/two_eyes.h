// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace disparityd::capture {

/// Throws std::invalid_argument with one line where the files or folders of the two eyes are one and the same: all of
/// the scene would read as infinitely far. What is not there passes.
inline void check_two_eyes(const std::string& left, const std::string& right) {
    std::error_code ignored;
    if (std::filesystem::equivalent(left, right, ignored)) {
        throw std::invalid_argument(left + ": is named for both eyes, expected one of each eye: LEFT,RIGHT");
    }
}

}  // namespace disparityd::capture
