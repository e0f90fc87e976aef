// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace disparityd::daemon {

/// The deepest nesting that is allowed. A parser of TOML recurses for each part of a dotted key and each nested
/// bracket, both when it parses and when it frees the result: the text would decide how much stack that takes. Deeper
/// text is refused before it is parsed. Keys of disparityd have at most two parts, values at most one bracket.
inline constexpr int deepest_toml = 16;

/// Returns the first place that is nested too deeply, as "NAME:LINE: found ..., allowed: ..."; empty if there is none.
/// Dots and brackets within strings and comments do not count. Accepts any bytes and takes a constant amount of memory.
std::string toml_depth_problem(std::string_view text, const std::string& name);

}  // namespace disparityd::daemon
