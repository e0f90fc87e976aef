// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/live_frame.h"

#include "proto/monotonic_clock.h"
#include "proto/products.h"

namespace disparityd::web {
namespace {

bool is_sound(const disparity::PlaneData& plane) {
    if (plane.product == disparity::Product::scan) {
        return true;  // a record, which is checked when it is read
    }
    const auto number = static_cast<std::uint32_t>(plane.product);
    return number >= 1 && number <= proto::products.size() &&
           plane.bytes_per_pixel == proto::products[number - 1].bytes_per_pixel &&
           plane.bytes.size() == std::uint64_t{plane.width} * plane.height * plane.bytes_per_pixel;
}

}  // namespace

void leave_out_unsound_planes(disparity::Frame& frame) {
    std::erase_if(frame.planes, [](const disparity::PlaneData& plane) { return !is_sound(plane); });
}

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
