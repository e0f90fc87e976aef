// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace disparityd::tools {

/// Throws with one line when a file cannot be made there: std::invalid_argument when its folder is not there or it is a
/// folder itself, std::runtime_error when the folder may not be written to. To be called before work whose result goes
/// there.
void check_writable(const std::string& path);

/// Throws std::invalid_argument with one line when there is a file already and `force` is false. For a file whose
/// folder is made later.
void check_absent(const std::string& path, bool force);

/// Both.
void check_output(const std::string& path, bool force);

}  // namespace disparityd::tools
