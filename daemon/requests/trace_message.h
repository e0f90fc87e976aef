// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "pipeline/trace.h"
#include "proto/disparity.pb.h"

namespace disparityd::daemon {

/// Returns a trace as the parts in which it is sent, each smaller than a message may be; at least one.
std::vector<v1::Trace> to_messages(const pipeline::TraceLog& log);

}  // namespace disparityd::daemon
