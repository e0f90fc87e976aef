// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tools/images/picture.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace disparityd::tools {

/// Adds --colour-range, which says the disparities of the first and the last colour of a picture.
CLI::Option* add_colour_range(CLI::App& app, std::string& word);

/// Returns what the word means; empty: the default.
images::ColourRange colour_range(const std::string& word);

}  // namespace disparityd::tools
