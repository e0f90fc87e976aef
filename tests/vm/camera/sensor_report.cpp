// SPDX-License-Identifier: Apache-2.0
#include "tests/vm/camera/sensor_report.h"

namespace simulated_camera {

Bytes sensor_report(std::uint32_t number, std::int64_t monotonic_ns) {
    const bool with_environment = number % reports_per_environment == 0;
    const std::uint8_t state = with_environment ? 2 : 1;
    Bytes report{1, 0};
    append_little_endian(report, static_cast<std::uint64_t>(monotonic_ns + sensor_clock_ahead_ns) * 2 / 78'125, 8);
    for (const std::uint32_t count : {number % 32'768, 0U, 0U, 0U, 0U, 4'096U}) {
        append_little_endian(report, count, 2);
    }
    append_little_endian(report, 0x0100, 2);  // can be synchronised with frames, this one is not
    append_little_endian(report, number / 4, 4);
    append_little_endian(report, 3'112, 2);  // 0.01 degrees
    report.push_back(state);
    for (const std::uint32_t count : {320U, 0U, 0U}) {  // 1/16 microtesla
        append_little_endian(report, count, 2);
    }
    report.resize(47);  // neither moved nor falling
    report.push_back(state);
    append_little_endian(report, 2'500, 2);
    append_little_endian(report, 101'325, 4);
    append_little_endian(report, 51'200, 4);
    append_little_endian(report, 3'950, 2);
    append_little_endian(report, 4'025, 2);
    report.resize(64);
    return report;
}

}  // namespace simulated_camera
