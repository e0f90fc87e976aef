// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "capture/sensor_sample.h"

namespace disparityd::capture {

/// Ends a message about what is wrong with the sensor's files.
inline constexpr const char* without_inertial_sensor =
    "; ?imu=off behind the folder plays its images without the inertial sensor";

/// Reads imu0/data.csv of EuRoC and TUM-VI from the beginning to the end: a line for each sample with its time in ns,
/// the angular velocity (rad/s) and the acceleration (m/s²), x y z each. Takes memory for one line, however long the
/// file is. All functions but the constructor throw std::runtime_error with one line (file, line, found, expected) for
/// what is no such line, and for times that do not rise.
class InertialList {
public:
    /// Throws std::invalid_argument with one line for a file that cannot be opened.
    explicit InertialList(std::string path);

    /// Puts the samples up to this time, and with it, in place of those in `samples`, with camera_ns as the file has it
    /// and no other time. Of more than a frame may carry the newest stay; the first one counts the others as lost.
    void take_until(std::int64_t time_ns, std::vector<SensorSample>& samples);

    /// Passes over the samples up to this time, and with it.
    void skip_until(std::int64_t time_ns);

    /// Begins anew.
    void rewind();

private:
    std::optional<SensorSample> read();
    [[noreturn]] void fail(const std::string& what) const;

    std::string path_;
    std::ifstream file_;
    std::optional<SensorSample> next_;  ///< that was read and not taken
    std::optional<std::int64_t> last_ns_;
    std::uint64_t line_ = 0;
};

}  // namespace disparityd::capture
