// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <new>

#include "daemon/log.h"

namespace disparityd::daemon {

/// Runs a piece of work, and returns whether it came to its end. An exception ends this piece only, with a line of the
/// log that begins with `what`; one for want of memory is let through, and ends the daemon.
template <typename Work>
bool ends_alone(const char* what, Work&& work) {
    try {
        work();
        return true;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (...) {
        log_caught(what);
        return false;
    }
}

}  // namespace disparityd::daemon
