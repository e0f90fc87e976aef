// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "daemon/config/config.h"

namespace disparityd::daemon {

/// Returns the number of workers for a pool: [pipeline] workers, or as many as [pipeline] cores asks for, at most one
/// per core that the process may use; 0 = one for each of those.
int configured_workers(const Config& config);

/// Returns a line for people: what [pipeline] cores means here, with so many workers; empty where it is "all". `live`:
/// whether newer frames go before older ones, so that some may be left out.
std::string core_share_note(const Config& config, int workers, bool live);

}  // namespace disparityd::daemon
