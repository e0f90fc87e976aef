// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include <yaml-cpp/yaml.h>

namespace disparityd::calibration {

/// Reads YAML whose first line is OpenCV's ("%YAML:1.0", which is not YAML), the standard's ("%YAML 1.2") or missing,
/// and JSON, which is YAML, too. The result is a map whose keys are words, each there once. Throws
/// std::invalid_argument with one line: `path`, the line in the file; `kind` says what it should be.
YAML::Node read_yaml_map(const std::string& path, std::string_view text, const std::string& kind);

/// Returns the word of a scalar; an empty one for everything else.
std::string word_of(const YAML::Node& node);

}  // namespace disparityd::calibration
