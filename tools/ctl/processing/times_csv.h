// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "tools/ctl/describe.h"

namespace disparityd::tools {

constexpr const char* times_name = "times.csv";

/// Returns how the first line of times.csv begins, and that of a frame, number `index`, as the manifest tells it; each
/// with a comma at its end. Behind them are the times of steps.
std::string times_head();
std::string times_columns(std::uint64_t index, const Json& frame);

}  // namespace disparityd::tools
