// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace disparity {

/// Reads a token: of the first line that is neither empty nor begins with #, the last word. A line of the daemon's
/// file, "view TOKEN", will do. An empty path gives an empty token. Throws std::invalid_argument with one line when the
/// file cannot be read or holds none, and when every user may read it.
std::string read_token(const std::string& path);

}  // namespace disparity
