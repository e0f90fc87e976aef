// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>

namespace disparityd::bridges {

/// From here on the first SIGTERM or SIGINT only sets the flag that is returned, so that the program can end in order;
/// a second one of the same kind ends it at once. The flag lives as long as the program.
const std::atomic<bool>& catch_stop_signals();

}  // namespace disparityd::bridges
