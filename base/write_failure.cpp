// SPDX-License-Identifier: Apache-2.0
#include "base/write_failure.h"

#include <cerrno>

#include "base/failure_text.h"

namespace disparityd::base {

void refuse_to_write(const std::string& path, int error) {
    const std::string text = path + ": cannot be written" + (error == 0 ? "" : ": " + error_text(error));
    if (error == ENOSPC || error == EDQUOT) {
        throw DiskFull(text);
    }
    throw std::runtime_error(text);
}

}  // namespace disparityd::base
