// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace disparityd::tools {

/// Throws std::invalid_argument with one line when there is a file already and `force` is false.
void check_output(const std::string& path, bool force);

}  // namespace disparityd::tools
