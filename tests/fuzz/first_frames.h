// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "capture/frame_source.h"
#include "capture/recording/recording_reader.h"
#include "tests/fuzz/outcome.h"

namespace disparityd::fuzz {

/// Reads the first frames of a file. What the reader throws is the caller's.
inline void read_first_frames(capture::RecordingReader& reader) {
    std::vector<std::uint8_t> pixels(reader.frame_bytes());
    capture::recording::FrameFacts facts;
    for (int i = 0; i < 4 && reader.read(facts, pixels.data()); ++i) {
        expect(facts.sensors.size() <= capture::RawFrame::most_samples, "more samples than a frame carries");
    }
}

}  // namespace disparityd::fuzz
