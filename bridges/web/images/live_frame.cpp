// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/images/live_frame.h"

#include "proto/monotonic_clock.h"

namespace disparityd::web {

double age_ms(const LiveFrame& live) {
    constexpr std::int64_t plausible_ns = 5'000'000'000;
    const std::int64_t waited_ns =
        std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now() - live.received).count();
    const std::int64_t told = live.frame.age_ns + waited_ns;
    const std::int64_t by_clock = proto::monotonic_ns() - live.frame.monotonic_ns;
    const std::int64_t age = by_clock >= told && by_clock - told < plausible_ns ? by_clock : told;
    return static_cast<double>(age) / 1e6;
}

}  // namespace disparityd::web
