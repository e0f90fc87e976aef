// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

#include "kernels/raw_image.h"

namespace disparityd::capture {

/// Returns the name in recordings (docs/recordings.md) and messages; "unknown" for no value of the enumeration.
std::string_view to_string(PixelFormat format);

/// Returns nullopt when no format has this name.
std::optional<PixelFormat> pixel_format_from_name(std::string_view text);

}  // namespace disparityd::capture
