// SPDX-License-Identifier: Apache-2.0
//
// HID reports of a camera's sensors, and what a recording keeps of them.
#include <cmath>

#include "capture/recording/recording_sensors.h"
#include "capture/sensors/sensor_report.h"
#include "tests/fuzz/outcome.h"

using namespace disparityd;

namespace {

bool is_finite(const capture::SensorVector& vector) {
    return std::isfinite(vector.x) && std::isfinite(vector.y) && std::isfinite(vector.z);
}

void read_report(std::span<const std::uint8_t> bytes, std::uint16_t firmware) {
    const auto sample = capture::parse_sensor_report(bytes, firmware);
    if (!sample) {
        return;
    }
    fuzz::expect(bytes.size() >= capture::sensor_report_bytes, "a sample of a report that is too short");
    fuzz::expect(sample->camera_ns >= 0, "a time before the camera's clock began");
    fuzz::expect(is_finite(sample->angular_velocity) && is_finite(sample->acceleration) &&
                     is_finite(sample->magnetic_field) && std::isfinite(sample->hectopascal),
                 "a report of whole numbers became no number");
    const std::vector<capture::SensorSample> written{*sample, *sample};
    std::vector<std::uint8_t> kept(capture::recording::sensors_size(written));
    capture::recording::put_sensors(written, kept);
    const auto again = capture::recording::get_sensors(kept);
    fuzz::expect(again && *again == written, "samples changed in a recording");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::span<const std::uint8_t> bytes(data, size);
    read_report(bytes, 0x0300);
    read_report(bytes, 0x0309);
    if (const auto samples = capture::recording::get_sensors(bytes)) {
        fuzz::expect(samples->size() <= size, "more samples than bytes");
    }
    return 0;
}
