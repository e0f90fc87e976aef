// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "tools/ctl/describe.h"

namespace disparityd::tools {

/// Returns what a source is made of: "source", the text as typed; "files" and "bytes", how many files it has and how
/// many bytes they have together; "listing", the SHA-256 of their names, sizes and times of change. The last three are
/// null where it is no file. The content is not read. Throws std::invalid_argument where images do not pair.
Json facts_of_input(const std::string& uri);

/// Returns the SHA-256 of what its files hold: of a line for each, in the order of their names, with the SHA-256 of its
/// bytes and a line feed; null where it is no file. It does not depend on where they lie. Reads all of it; `stop` is
/// asked meanwhile, and what it ends is null. Throws std::invalid_argument when a file cannot be read.
Json content_of_input(const std::string& uri, const std::function<bool()>& stop);

/// Returns the SHA-256 of what --calibration names: of one file, or of what the files and the settings behind them say
/// ("left.yaml,right.yaml?unit=m"). Throws std::invalid_argument when a file cannot be read.
std::string content_of_calibration(const std::string& name);

/// Throws std::invalid_argument with one line when a file is among those of a source, by this name or another one: it
/// would be emptied while it is read. Throws as facts_of_input().
void refuse_file_of_source(const std::string& file, const std::string& uri);

}  // namespace disparityd::tools
