// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "tools/ctl/describe.h"

namespace disparityd::tools {

/// Returns the parameters (see parameters_of()) of the run in a folder, finished or not, as its manifest begins with
/// them; nothing where no manifest was begun.
std::optional<Json> begun_with(const std::string& folder);

/// Throws std::invalid_argument with one line where the run in the folder has other parameters.
void check_begun_with(const std::string& folder, const Json& parameters);

/// Throws std::invalid_argument: the folder was made with what the text says.
[[noreturn]] void refuse_made_with(const std::string& folder, const std::string& difference);

/// Returns why a run that has its manifest is not done: "out/000001.png: is missing or empty", that the manifest is
/// damaged, or that frames were left out, as what kept them from being read may have passed; empty: it is done. `scan`
/// is the file of the obstacle scans; empty: none. Throws std::invalid_argument for a manifest of another version.
std::string lack_of(const std::string& folder, const std::string& scan);

}  // namespace disparityd::tools
