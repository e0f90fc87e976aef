// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "proto/disparity.pb.h"

namespace disparityd::ros {

/// Returns a diagnostic_msgs/msg/DiagnosticArray of the daemon's status: one entry `name`, OK while it runs and nobody
/// must mend anything; WARN when it tells notices, an alarm or waits; ERROR when it is in no state to serve frames.
std::string diagnostic_message(const v1::Status& status, const std::string& name, std::int64_t realtime_ns);

/// Returns the same of a daemon that is away: STALE, and `why` as its line.
std::string stale_diagnostic(const std::string& why, const std::string& name, std::int64_t realtime_ns);

/// Returns the same of a daemon whose frames come while it tells no status, as over shared memory alone: WARN.
std::string no_status_diagnostic(const std::string& why, const std::string& name, std::int64_t realtime_ns);

}  // namespace disparityd::ros
