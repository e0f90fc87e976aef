// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "capture/frame_source.h"
#include "tests/temporary_folder.h"

namespace disparityd::capture::test {

using disparityd::test::TemporaryFolder;

SourceInfo make_info(PixelFormat format, int eye_width, int height);
calibration::StereoCalibration make_calibration(int width, int height);

/// A frame that owns its pixels. Odd numbers are noise, the others smooth or constant, so that the codec's tables
/// change from frame to frame. Rows have a gap between them.
struct OwnedFrame {
    RawFrame frame;
    std::vector<std::uint8_t> bytes;  ///< with the gaps
    std::vector<SensorSample> sensors;
};
/// Every field another value; odd ones among them.
SensorSample make_sample(int number);
OwnedFrame make_frame(const SourceInfo& info, int number);

/// A frame as it was delivered, rows without gaps.
struct SeenFrame {
    std::vector<std::uint8_t> pixels;
    std::uint64_t sequence = 0;
    std::int64_t monotonic_ns = 0;
    std::int64_t realtime_ns = 0;
    std::uint32_t flags = 0;
    std::uint32_t dropped_before = 0;
    calibration::CalibrationCorrection correction;
    std::vector<SensorSample> sensors;

    bool operator==(const SeenFrame&) const = default;
};
SeenFrame seen(const RawFrame& frame);

/// Writes frames 0 .. count - 1 of make_frame().
void write_recording(const std::string& path, const SourceInfo& info, int count);

struct Replay {
    SourceInfo info;
    std::vector<SeenFrame> frames;
    std::string error;  ///< what next() threw; empty = the source ended well
};
/// Plays a file to its end, or at most `limit` frames. What open throws goes to the caller.
Replay replay(const std::string& path, bool loop = false, std::size_t limit = SIZE_MAX);

/// The message of the exception that opening the file throws; fails the test when it throws another type, or none.
std::string refusal(const std::string& path);

std::vector<std::uint8_t> file_bytes(const std::string& path);
void put_file(const std::string& path, const std::uint8_t* bytes, std::size_t size);

}  // namespace disparityd::capture::test
