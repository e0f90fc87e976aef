// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace disparityd::foxglove {

/// Returns the JSON schema of the daemon's status, as the channel /status sends it.
std::string status_schema();

}  // namespace disparityd::foxglove
