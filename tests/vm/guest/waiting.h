// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <thread>

namespace vm_guest {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// Long enough for anything on a machine that is emulated, on a host that has other work.
inline constexpr seconds patience{30};

/// Whether the condition comes true before the patience ends.
inline bool eventually(const std::function<bool()>& condition, std::chrono::steady_clock::duration limit = patience) {
    const auto end = std::chrono::steady_clock::now() + limit;
    while (!condition()) {
        if (std::chrono::steady_clock::now() > end) {
            return false;
        }
        std::this_thread::sleep_for(milliseconds(5));
    }
    return true;
}

}  // namespace vm_guest
