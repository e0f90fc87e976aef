// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "clients/cpp/disparity_client.hpp"
#include "tools/eval/scan/course.h"

namespace disparityd::reaction {

/// A pole that appears, as the camera sees it.
struct Pole {
    double distance_m = 0;
    double bearing_deg = 0;
};

/// A recording of rounds: each is an open floor for some frames, then the same floor with a pole on it.
struct PolePlan {
    eval::CourseCamera camera{1280, 720, 700, 0.12, 0.3};
    double rate = 15;
    int without = 20;  ///< frames of a round before the pole appears
    int with = 10;     ///< frames with it
    int rounds = 6;    ///< with another floor and another pole each

    int frames_per_round() const { return without + with; }
};

/// Draws and writes the recording; returns the poles of its rounds. The same plan gives the same frames. `progress`
/// hears how many rounds are done. Throws as capture::RecordingWriter does.
std::vector<Pole> write_pole_recording(const std::string& path, const PolePlan& plan,
                                       const std::function<void(int done)>& progress);

/// Returns whether a scan shows the pole: an obstacle within 15 % of its distance in its sector, or in the next one.
bool shows(const disparity::Scan& scan, const Pole& pole);

}  // namespace disparityd::reaction
