// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace disparityd::formats {

/// Returns the definition of a type of ROS 2 as its package publishes it, with all types that it has, as a file of
/// messages would hold it: for bags that hold none. Empty for a type that is not read here.
std::string_view published_definition(std::string_view type);

}  // namespace disparityd::formats
