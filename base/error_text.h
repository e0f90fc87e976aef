// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace disparityd::base {

/// Returns the system's text for an error number. Where the cause is this program and not the file or device (too many
/// open files, no memory), the text says so and what to do.
std::string error_text(int code);

}  // namespace disparityd::base
