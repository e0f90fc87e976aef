// SPDX-License-Identifier: Apache-2.0
//
// Writes one frame of each kind to standard output, for decode.cjs, which knows what must be in them.
#include <cstdio>

#include "bridges/mavlink/heartbeat.h"
#include "bridges/mavlink/obstacle_message.h"

int main() {
    using namespace disparityd::mavlink;
    using disparity::SectorState;
    const DistanceLimits limits{25, 1000};
    disparity::Scan scan;
    scan.sectors = {
        {.from_deg = -17.5, .to_deg = -12.5, .state = SectorState::free, .free_m = 12},
        {.from_deg = -12.5,
         .to_deg = -7.5,
         .state = SectorState::occupied,
         .distance_m = 3.456,
         .low_m = 0.1,
         .high_m = 0.4},
        {.from_deg = 27.5, .to_deg = 32.5, .state = SectorState::occupied, .distance_m = 6, .low_m = 0.1, .high_m = 2}};
    FrameWriter writer(42, 196);
    const auto write = [&writer](const Message& message) {
        const auto bytes = writer.frame(message);
        return std::fwrite(bytes.data(), 1, bytes.size(), stdout) == bytes.size();
    };
    bool good = write(heartbeat(SystemState::critical)) &&
                write(obstacle_distance(sector_distances(scan, limits), limits, 1234567890123456ULL));
    for (const Message& message : obstacles_3d(scan, limits, 1.0, 987654321)) {
        good = good && write(message);
    }
    return good ? 0 : 1;
}
