// SPDX-License-Identifier: Apache-2.0
#include "base/waker.h"

#include <algorithm>

#include <poll.h>

namespace disparityd::base {

Wakening wait_for_device(int device, Waker& waker, std::chrono::steady_clock::time_point deadline) {
    pollfd watched[] = {{waker.descriptor(), POLLIN, 0}, {device, POLLIN, 0}};
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now()).count();
    const int timeout = static_cast<int>(std::clamp<std::int64_t>(left, 0, 60'000));
    if (::poll(watched, device < 0 ? 1 : 2, timeout) <= 0) {
        return {};
    }
    Wakening wakening;
    wakening.woken = watched[0].revents != 0;
    if (wakening.woken) {
        waker.clear();
    }
    wakening.readable = (watched[1].revents & POLLIN) != 0;
    wakening.failed = (watched[1].revents & (POLLERR | POLLHUP | POLLNVAL)) != 0;
    return wakening;
}

}  // namespace disparityd::base
