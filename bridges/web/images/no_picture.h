// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace disparityd::web {

/// Returns a JPEG of this size (px) for viewers that show the last picture until another one comes: black, with the
/// words "no picture". Throws std::runtime_error when the library refuses.
std::string no_picture_jpeg(int width, int height);

}  // namespace disparityd::web
