// SPDX-License-Identifier: Apache-2.0
//
// What is recorded from a live camera is what the camera sent.
#include <gtest/gtest.h>

#include "capture/recording_reader.h"
#include "tests/daemon/daemon_process.h"
#include "tests/vm/camera/test_pattern.h"
#include "tests/vm/guest/camera_process.h"
#include "tests/vm/guest/waiting.h"

namespace vm_guest {
namespace {

TEST(Record, EveryFrameIsWholeToTheByteAndInOrder) {
    const CameraProcess camera;
    const disparityd::test::TemporaryFolder folder;
    const std::string file = folder.path() + "/live.mkv";
    disparityd::test::DaemonProcess recording(folder, {"record", file, "--source", "v4l2:vga@15", "--frames", "30"}, {},
                                              "/vm/disparityctl");
    ASSERT_EQ(recording.wait_for_exit(patience), 0) << recording.log();

    disparityd::capture::RecordingReader reader(file);
    std::vector<std::uint8_t> frame(reader.frame_bytes());
    ASSERT_EQ(frame.size(), 2U * 1344 * 376);
    disparityd::capture::recording::FrameFacts facts;
    std::uint32_t last_number = 0;
    std::uint64_t last_sequence = 0;
    int frames = 0;
    for (; reader.read(facts, frame.data()); ++frames) {
        EXPECT_EQ(simulated_camera::first_difference_from_pattern(frame), -1) << "frame " << frames;
        const std::uint32_t number = simulated_camera::pattern_number(frame);
        if (frames > 0) {
            EXPECT_GT(number, last_number);
            EXPECT_EQ(facts.sequence, last_sequence + 1 + facts.dropped_before);
        }
        last_number = number;
        last_sequence = facts.sequence;
    }
    EXPECT_EQ(frames, 30);
}

}  // namespace
}  // namespace vm_guest
