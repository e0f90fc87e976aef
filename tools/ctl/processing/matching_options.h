// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/ctl/processing/process_arguments.h"

namespace CLI {
class App;
}  // namespace CLI

namespace disparityd::tools {

/// Adds the options of all commands that match the frames of a source: how they are rectified and matched, how many,
/// and what is rejected afterwards. `arguments` outlive the command.
void add_matching_options(CLI::App& command, ProcessArguments& arguments);

}  // namespace disparityd::tools
