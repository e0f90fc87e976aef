// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "pipeline/worker_pool.h"
#include "tools/ctl/processing/process_arguments.h"
#include "tools/ctl/processing/shards/source_list.h"

namespace disparityd::tools {

/// Tells how many frames the sources have, and how long shards of them would take: opens all, processes some frames of
/// the first ones into a folder for temporary files, which it removes. A source that cannot be opened, or whose length
/// is not known, is told. Writes nothing else. Returns the exit status. Throws as process_source().
int plan(const ProcessArguments& arguments, const std::vector<ListedSource>& sources, pipeline::WorkerPool& workers);

}  // namespace disparityd::tools
