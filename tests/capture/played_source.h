// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <exception>
#include <string>
#include <vector>

#include "capture/frame_source.h"
#include "tests/capture/images/image_fixture.h"

namespace disparityd::capture::test {

/// What a source gives from its first frame to its last, copied.
struct Played {
    SourceInfo info;
    std::vector<std::string> notices;
    std::vector<std::vector<std::uint8_t>> frames;
    std::vector<std::uint64_t> sequences;
    std::vector<std::uint32_t> lost;
    std::vector<std::int64_t> times;
    std::vector<SensorSample> samples;
    std::string problem;  ///< empty: the source ended well
};

/// What opening or reading throws becomes the problem; it must be one line.
inline Played play_all(SourceOptions options) {
    Played played;
    options.pace = Pace::fastest;
    options.report = [&](const std::string& line, bool) { played.notices.push_back(line); };
    try {
        const auto source = open_source(options);
        played.info = source->info();
        RawFrame frame;
        while (source->next(frame, soon()) == FrameSource::Next::frame) {
            std::vector<std::uint8_t>& bytes = played.frames.emplace_back();
            for (int y = 0; y < frame.image.height; ++y) {
                const std::uint8_t* row = frame.image.data + y * frame.image.stride;
                bytes.insert(bytes.end(), row, row + 2 * frame.image.eye_width * bytes_per_pixel(frame.image.format));
            }
            played.sequences.push_back(frame.sequence);
            played.lost.push_back(frame.dropped_before);
            played.times.push_back(frame.realtime_ns);
            played.samples.insert(played.samples.end(), frame.sensors.begin(), frame.sensors.end());
            source->give_back(frame);
        }
    } catch (const std::exception& error) {
        played.problem = error.what();
        EXPECT_EQ(played.problem.find('\n'), std::string::npos) << played.problem;
    }
    return played;
}

}  // namespace disparityd::capture::test
