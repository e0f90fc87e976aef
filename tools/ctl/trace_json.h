// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <ostream>

#include "proto/disparity.pb.h"

namespace disparityd::tools {

/// Writes a trace in the JSON trace event format that Perfetto and chrome://tracing read: a row for each thread, a row
/// for each queue, and arrows that follow a frame from stage to stage. Times begin at 0. Returns how many events the
/// trace has. What the daemon sends is text and numbers of any kind; the output is valid all the same.
std::uint64_t write_trace_json(std::ostream& out, const v1::Trace& trace);

/// Returns how many events the daemon had no room for.
std::uint64_t dropped_events(const v1::Trace& trace);

}  // namespace disparityd::tools
