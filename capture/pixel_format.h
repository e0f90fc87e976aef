// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

#include "kernels/raw_image.h"

namespace disparityd::capture {

/// As recordings (docs/recordings.md) and messages have it; "unknown" for no value of the enumeration.
std::string_view name(PixelFormat format);

/// Empty for the name of none.
std::optional<PixelFormat> pixel_format_from_name(std::string_view text);

}  // namespace disparityd::capture
