// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <sys/types.h>

namespace disparityd::tools {

/// Writes a new file, from the beginning with its mode; never over a file or through a link of somebody else. Throws
/// std::runtime_error with one line when the system refuses; then there is no file.
void write_new_file(const std::string& path, const std::string& text, mode_t mode);

}  // namespace disparityd::tools
