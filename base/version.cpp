// SPDX-License-Identifier: Apache-2.0
#include "base/version.h"

#include "base/version_numbers.h"

namespace disparityd::base {

std::string version_line(std::string_view program) {
    const std::string_view commit = DISPARITYD_COMMIT;
    std::string line(program);
    line += " " DISPARITYD_VERSION;
    if (!commit.empty()) {
        line.append(" (commit ").append(commit).append(")");
    }
    return line;
}

}  // namespace disparityd::base
