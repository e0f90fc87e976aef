// SPDX-License-Identifier: Apache-2.0
//
// An offset is added to the stamps of frames once, by whoever reads the camera or replays what was recorded without
// one.
#include <algorithm>

#include <gmock/gmock.h>

#include "capture/recording/recording_writer.h"
#include "tests/capture/recording/record_fixture.h"

namespace disparityd::capture::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr int offset_us = -2500;

struct Played {
    SourceInfo info;
    std::vector<SeenFrame> frames;
    std::vector<std::string> troubles;
    std::vector<std::string> notes;
};

class TimeOffset : public ::testing::Test {
protected:
    TimeOffset() { write_recording(plain_, made_, 3); }

    /// Plays a file with an offset and, where `record_as` names one, records what comes.
    static Played play(const std::string& path, int offset, const std::string& record_as = {}) {
        Played played;
        SourceOptions options;
        options.uri = path;
        options.pace = Pace::fastest;
        options.time_offset_us = offset;
        options.report = [&](const std::string& line, bool trouble) {
            (trouble ? played.troubles : played.notes).push_back(line);
        };
        const auto source = open_source(options);
        played.info = source->info();
        std::optional<RecordingWriter> writer;
        if (!record_as.empty()) {
            writer.emplace(record_as, played.info);
        }
        RawFrame frame;
        while (source->next(frame, std::chrono::steady_clock::now() + std::chrono::seconds(60)) ==
               FrameSource::Next::frame) {
            played.frames.push_back(seen(frame));
            if (writer) {
                writer->write(frame);
            }
            source->give_back(frame);
        }
        if (writer) {
            writer->close();
        }
        return played;
    }

    TemporaryFolder folder_;
    SourceInfo made_ = make_info(PixelFormat::grey8, 32, 24);
    const std::string plain_ = folder_.file("plain.mkv");
    const std::string moved_ = folder_.file("moved.mkv");
};

TEST_F(TimeOffset, MovesTheFramesOnBothClocksAndNothingElse) {
    std::vector<SeenFrame> expected = play(plain_, 0).frames;
    ASSERT_EQ(expected.size(), 3U);
    for (SeenFrame& frame : expected) {
        frame.monotonic_ns += offset_us * 1000;
        frame.realtime_ns += offset_us * 1000;
    }
    const Played moved = play(plain_, offset_us);
    EXPECT_TRUE(moved.frames == expected);
    EXPECT_EQ(moved.info.time_offset_us, offset_us);
    EXPECT_THAT(moved.troubles, ElementsAre());
}

TEST_F(TimeOffset, ARecordingContainsItAndIsNotMovedAgain) {
    const Played recorded = play(plain_, offset_us, moved_);
    for (const int again : {0, offset_us, 700}) {
        const Played replayed = play(moved_, again);
        EXPECT_TRUE(replayed.frames == recorded.frames) << again;
        EXPECT_EQ(replayed.info.time_offset_us, offset_us) << again;
    }
    EXPECT_THAT(play(moved_, offset_us).troubles, ElementsAre());
    EXPECT_THAT(play(moved_, 700).troubles,
                ElementsAre("source " + moved_ +
                            ": its stamps contain an offset of -2500 us since they were recorded; "
                            "time_offset_us = 700 is not added"));
}

TEST_F(TimeOffset, ARecordingOfAReplayContainsItToo) {
    const Played recorded = play(plain_, offset_us, moved_);
    const std::string third = folder_.file("third.mkv");
    play(moved_, 0, third);
    const Played replayed = play(third, offset_us);
    EXPECT_EQ(replayed.info.time_offset_us, offset_us);
    EXPECT_TRUE(replayed.frames == recorded.frames);
}

TEST_F(TimeOffset, ARecordingWithoutOneHasTheBytesOfBefore) {
    const std::vector<std::uint8_t> bytes = file_bytes(plain_);
    const std::string tag = "TIME_OFFSET";
    EXPECT_EQ(std::search(bytes.begin(), bytes.end(), tag.begin(), tag.end()), bytes.end());
}

TEST_F(TimeOffset, ADamagedTagIsRefused) {
    play(plain_, offset_us, moved_);
    for (const std::string damage : {"-25x0", "-2.50", "9e099", "  nan"}) {
        std::vector<std::uint8_t> bytes = file_bytes(moved_);
        const std::string value = "-2500";
        const auto place = std::search(bytes.begin(), bytes.end(), value.begin(), value.end());
        ASSERT_NE(place, bytes.end());
        std::copy(damage.begin(), damage.end(), place);
        put_file(folder_.file("damaged.mkv"), bytes.data(), bytes.size());
        EXPECT_THAT(refusal(folder_.file("damaged.mkv")),
                    HasSubstr("its tag DISPARITYD_TIME_OFFSET_US says \"" + damage + "\""));
    }
}

}  // namespace
}  // namespace disparityd::capture::test
