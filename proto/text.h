// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace disparityd::proto {

/// Text from outside, a file's name or what a device says, as a string of a message: bytes that are no UTF-8 are "?".
/// With them, no receiver could read the message.
std::string text(std::string_view from);

}  // namespace disparityd::proto
