// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/recording/recorder.h"
#include "capture/recording/recording_sensors.h"
#include "capture/recording/recording_writer.h"
#include "tests/capture/recording/record_fixture.h"

namespace disparityd::capture::test {
namespace {

using recording::get_sensors;
using ::testing::HasSubstr;

std::vector<std::uint8_t> stored_bytes(const std::vector<SensorSample>& samples) {
    std::vector<std::uint8_t> bytes(recording::sensors_size(samples));
    recording::put_sensors(samples, bytes);
    return bytes;
}

TEST(RecordSensors, EveryFieldComesBack) {
    const std::vector samples{make_sample(1), make_sample(20), make_sample(300)};
    EXPECT_EQ(get_sensors(stored_bytes(samples)), samples);
    EXPECT_EQ(stored_bytes({}).size(), 8U) << "their number";
    EXPECT_EQ(get_sensors(stored_bytes({})), std::vector<SensorSample>{});
    EXPECT_EQ(get_sensors({}), std::vector<SensorSample>{});
}

TEST(RecordSensors, ALaterVersionMayAddToSamplesAndBehindThem) {
    const std::vector samples{make_sample(1), make_sample(2)};
    std::vector<std::uint8_t> longer = stored_bytes(samples);
    ASSERT_EQ(longer.size(), 8U + 2 * 96);
    longer[4] = 98;
    for (const std::ptrdiff_t end : {8 + 96, 8 + 98 + 96}) {
        longer.insert(longer.begin() + end, {0xAA, 0xBB});
    }
    EXPECT_EQ(get_sensors(longer), samples);
    longer.push_back(0xCC);
    EXPECT_EQ(get_sensors(longer), samples);
}

TEST(RecordSensors, DamagedOnesAreRefused) {
    const std::vector<std::uint8_t> whole = stored_bytes({make_sample(1), make_sample(2)});
    for (std::size_t size = 1; size < whole.size(); ++size) {
        const std::vector<std::uint8_t> part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
        EXPECT_FALSE(get_sensors(part)) << size;
    }
    for (const std::size_t at : {0U, 3U, 4U, 7U}) {
        std::vector<std::uint8_t> damaged = whole;
        damaged[at] = at == 4 ? 95 : 0xff;
        EXPECT_FALSE(get_sensors(damaged)) << at;
    }
}

TEST(RecordSensors, ADamagedRecordingSaysSo) {
    const TemporaryFolder folder;
    const std::string path = folder.file("r.mkv");
    write_recording(path, make_info(PixelFormat::grey8, 32, 16), 3);
    std::vector<std::uint8_t> bytes = file_bytes(path);
    const std::vector<std::uint8_t> second = stored_bytes(make_frame(make_info(PixelFormat::grey8, 1, 1), 1).sensors);
    const auto at = std::search(bytes.begin(), bytes.end(), second.begin(), second.end());
    ASSERT_NE(at, bytes.end());
    *at = 0xff;
    put_file(path, bytes.data(), bytes.size());
    const Replay played = replay(path);
    EXPECT_EQ(played.frames.size(), 2U);
    EXPECT_THAT(played.error, HasSubstr("damaged: 2 of 3 frames could be read, 1 frame was left out"));
}

TEST(RecordSensors, AFrameThatIsLostTakesItsSamplesWithItAndTheNextOneSaysSo) {
    const TemporaryFolder folder;
    const SourceInfo info = make_info(PixelFormat::grey8, 32, 16);
    Recorder recorder(folder.file("r.mkv"), info);
    std::vector<SensorSample> samples{SensorSample{}, SensorSample{}};
    samples[1].lost_before = 5;
    OwnedFrame lost = make_frame(make_info(PixelFormat::grey8, 16, 16), 1);
    lost.frame.sensors = samples;
    EXPECT_FALSE(recorder.offer(lost.frame)) << "another size";
    OwnedFrame without = make_frame(info, 0);
    EXPECT_TRUE(recorder.offer(without.frame));
    OwnedFrame next = make_frame(info, 1);
    next.frame.sensors = samples;
    EXPECT_TRUE(recorder.offer(next.frame));
    EXPECT_EQ(recorder.finish().error, "");
    const Replay played = replay(folder.file("r.mkv"));
    ASSERT_EQ(played.frames.size(), 2U);
    ASSERT_EQ(played.frames[1].sensors.size(), 2U);
    EXPECT_EQ(played.frames[1].sensors[0].lost_before, 7U);
    EXPECT_EQ(played.frames[1].sensors[1].lost_before, 5U);
}

}  // namespace
}  // namespace disparityd::capture::test
