// SPDX-License-Identifier: Apache-2.0
//
// The private data of recordings, and the file that keeps a correction: what stands beside each frame, where the
// segment lies, the calibration as text.
#include <array>

#include "calibration/online/correction_file.h"
#include "capture/recording/recording_format.h"
#include "capture/recording/recording_segment.h"
#include "tests/fuzz/memory_file.h"
#include "tests/fuzz/outcome.h"
#include "tests/fuzz/rectify.h"

using namespace disparityd;
namespace recording = capture::recording;

namespace {

constexpr int largest_maps = 128;  // pixels of a side; larger ones would only take longer

calibration::StereoCalibration known_calibration() {
    calibration::StereoCalibration calibration;
    calibration.width = 64;
    calibration.height = 48;
    calibration.left = calibration.right = {60, 60, 31.5, 23.5, {}};
    calibration.translation = {-100, 0, 0};
    return calibration;
}

void read_facts(std::span<const std::uint8_t> bytes) {
    const auto facts = recording::get_facts(bytes);
    if (!facts) {
        return;
    }
    std::array<std::uint8_t, recording::facts_size> again{};
    recording::put_facts(*facts, again);
    const auto same = recording::get_facts(again);
    fuzz::expect(same && same->sequence == facts->sequence && same->correction == facts->correction,
                 "the facts of a frame changed");
    if (is_plausible(facts->correction)) {
        fuzz::rectify(corrected(known_calibration(), facts->correction), "of the recording");
    }
}

void read_segment(std::span<const std::uint8_t> bytes) {
    if (const auto segment = capture::find_segment(bytes)) {
        fuzz::expect(segment->size_offset < segment->data_offset && segment->data_offset <= bytes.size() &&
                         segment->size_length >= 1 && segment->size_length <= 8,
                     "a segment outside of its file");
    }
}

void read_calibration(const std::string& text) {
    fuzz::accepted("calibration", [&] {
        const calibration::StereoCalibration calibration = calibration::calibration_from_text(text, "input");
        fuzz::expect_same_after_text(calibration);
        if (calibration.width <= largest_maps && calibration.height <= largest_maps) {
            fuzz::rectify(calibration, "input");
        }
    });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string text(fuzz::text_of(data, size));
    read_facts({data, size});
    read_segment({data, size});
    read_calibration(text);
    const fuzz::MemoryFile file(text);
    fuzz::accepted("correction " + file.path(), [&] {
        const auto correction = calibration::read_correction(file.path(), known_calibration());
        fuzz::expect(!correction || is_plausible(*correction), "a correction that no camera can need");
    });
    return 0;
}
