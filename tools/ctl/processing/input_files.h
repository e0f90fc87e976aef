// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tools/ctl/describe.h"

namespace disparityd::tools {

/// Returns what a source is made of: "source", the text as typed; "files" and "bytes", how many files it has and how
/// many bytes they have together; "listing", the SHA-256 of their names, sizes and times of change. The last three are
/// null where it is no file. The content is not read. Throws std::invalid_argument where images do not pair.
Json facts_of_input(const std::string& uri);

}  // namespace disparityd::tools
