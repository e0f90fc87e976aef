// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace disparityd::tools {

/// Throws std::invalid_argument with one line when a file stands there that the user has not said to replace.
void check_output(const std::string& path, bool force);

}  // namespace disparityd::tools
