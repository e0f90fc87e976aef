// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <filesystem>

namespace disparityd::test {

/// Returns the folder of third-party data, which may be missing: $DISPARITYD_DATA, else what the program was built
/// with.
inline std::filesystem::path data_folder() {
    const char* named = std::getenv("DISPARITYD_DATA");
    return named != nullptr ? named : DISPARITYD_DEFAULT_DATA;
}

}  // namespace disparityd::test
