// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bridges/web/metrics/web_counters.h"
#include "proto/disparity.pb.h"

namespace disparityd::test {

/// Returns a status that has everything: a camera, its sensors, a correction, a recording and two clients.
v1::Status filled_status();

/// Returns the same with text as nobody should choose it wherever text ends up in a label.
v1::Status hostile_status();

/// Returns what a daemon says before its first source is there.
v1::Status starting_status();

web::WebCounters web_counters();

}  // namespace disparityd::test
