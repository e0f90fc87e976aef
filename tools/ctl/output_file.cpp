// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/output_file.h"

#include <filesystem>
#include <stdexcept>

namespace disparityd::tools {

void check_output(const std::string& path, bool force) {
    std::error_code error;
    if (!force && std::filesystem::exists(path, error)) {
        throw std::invalid_argument(path + ": exists already, allowed: a new file, or --force to replace it");
    }
}

}  // namespace disparityd::tools
