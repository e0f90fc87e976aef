// SPDX-License-Identifier: Apache-2.0
// How a recording is played: pace, loop, loans, interruption.
#include <stdexcept>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/recording/recording_source.h"
#include "capture/recording/recording_writer.h"
#include "tests/capture/recording/record_fixture.h"

namespace disparityd::capture::test {
namespace {

using Clock = std::chrono::steady_clock;
using Next = FrameSource::Next;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

Clock::time_point soon() {
    return Clock::now() + std::chrono::seconds(60);
}

class RecordReplay : public ::testing::Test {
protected:
    /// Frames `distance` apart.
    void record(int count, nanoseconds distance) {
        RecordingWriter writer(path_, info_);
        for (int i = 0; i < count; ++i) {
            OwnedFrame made = make_frame(info_, i);
            made.frame.monotonic_ns = 5'000'000'000 + i * distance.count();
            writer.write(made.frame);
        }
        writer.close();
    }

    std::unique_ptr<FrameSource> open(Pace pace, bool loop = false, int loans = 2) const {
        SourceOptions options;
        options.uri = path_;
        options.pace = pace;
        options.loop = loop;
        options.loans = loans;
        return open_recording(options);
    }

    TemporaryFolder folder_;
    std::string path_ = folder_.file("r.mkv");
    SourceInfo info_ = make_info(PixelFormat::yuyv, 16, 8);
};

TEST_F(RecordReplay, KeepsTheRecordedDistances) {
    record(6, milliseconds(40));
    const auto source = open(Pace::source);
    RawFrame frame;
    const auto begin = Clock::now();  // the first frame is due when it is asked for
    for (int i = 0; i < 6; ++i) {
        ASSERT_EQ(source->next(frame, soon()), Next::frame);
        EXPECT_GE(Clock::now() - begin, milliseconds(40 * i)) << i;
        source->give_back(frame);
    }
    EXPECT_EQ(source->next(frame, soon()), Next::end);
}

TEST_F(RecordReplay, LosesNothingWhenTheTakerIsLate) {
    record(30, milliseconds(1));
    const auto source = open(Pace::source, false, 1);
    RawFrame frame;
    for (int i = 0; i < 30; ++i) {
        if (i == 10) {
            std::this_thread::sleep_for(milliseconds(50));
        }
        ASSERT_EQ(source->next(frame, soon()), Next::frame);
        EXPECT_EQ(frame.sequence, make_frame(info_, i).frame.sequence);
        source->give_back(frame);
    }
}

TEST_F(RecordReplay, TimesOutUntilAFrameIsDue) {
    record(2, std::chrono::hours(1));
    const auto source = open(Pace::source);
    RawFrame frame;
    ASSERT_EQ(source->next(frame, soon()), Next::frame);
    const auto before = Clock::now();
    EXPECT_EQ(source->next(frame, before + milliseconds(30)), Next::timeout);
    EXPECT_GE(Clock::now() - before, milliseconds(30));
    EXPECT_EQ(source->next(frame, Clock::now()), Next::timeout);
}

TEST_F(RecordReplay, LoopsWithRisingSequence) {
    record(5, milliseconds(1));
    const auto source = open(Pace::fastest, true);
    EXPECT_FALSE(source->info().frame_count.has_value());
    const std::uint64_t first = make_frame(info_, 0).frame.sequence;
    const std::uint64_t span = make_frame(info_, 4).frame.sequence - first + 1;
    for (int i = 0; i < 17; ++i) {
        RawFrame frame;
        ASSERT_EQ(source->next(frame, soon()), Next::frame);
        OwnedFrame expected = make_frame(info_, i % 5);
        expected.frame.monotonic_ns = 5'000'000'000 + i % 5 * 1'000'000;
        expected.frame.sequence += span * static_cast<std::uint64_t>(i / 5);
        if (i > 0 && i % 5 == 0) {
            expected.frame.flags |= frame_flag_discontinuity;
        }
        EXPECT_TRUE(seen(frame) == seen(expected.frame)) << i;
        source->give_back(frame);
    }
}

TEST_F(RecordReplay, LendsAtMostAsManyAsAgreed) {
    record(6, milliseconds(1));
    const auto source = open(Pace::fastest, false, 2);
    RawFrame a;
    RawFrame b;
    RawFrame c;
    ASSERT_EQ(source->next(a, soon()), Next::frame);
    ASSERT_EQ(source->next(b, soon()), Next::frame);
    const SeenFrame kept = seen(a);
    EXPECT_EQ(source->next(c, Clock::now() + milliseconds(20)), Next::timeout);
    std::thread giver([&] { source->give_back(b); });
    ASSERT_EQ(source->next(c, soon()), Next::frame);
    giver.join();
    EXPECT_EQ(c.sequence, make_frame(info_, 2).frame.sequence);
    EXPECT_TRUE(seen(a) == kept);  // a loan stays as it is
    EXPECT_TRUE(kept.pixels == seen(make_frame(info_, 0).frame).pixels);
}

TEST_F(RecordReplay, InterruptEndsAWaitForTheClock) {
    record(2, std::chrono::hours(1));
    const auto source = open(Pace::source);
    RawFrame frame;
    ASSERT_EQ(source->next(frame, soon()), Next::frame);
    std::thread other([&] {
        std::this_thread::sleep_for(milliseconds(20));  // most likely inside next() by then; right either way
        source->interrupt();
    });
    EXPECT_EQ(source->next(frame, Clock::time_point::max()), Next::interrupted);
    other.join();
    EXPECT_EQ(source->next(frame, soon()), Next::interrupted);
}

TEST_F(RecordReplay, InterruptEndsAWaitForALoan) {
    record(5, milliseconds(1));
    const auto source = open(Pace::fastest, false, 1);
    RawFrame frame;
    ASSERT_EQ(source->next(frame, soon()), Next::frame);
    std::thread other([&] {
        std::this_thread::sleep_for(milliseconds(20));
        source->interrupt();
    });
    EXPECT_EQ(source->next(frame, Clock::time_point::max()), Next::interrupted);
    other.join();
}

TEST_F(RecordReplay, ClosesInTheMiddle) {
    record(50, milliseconds(1));
    const auto source = open(Pace::fastest, true);
    RawFrame frame;
    ASSERT_EQ(source->next(frame, soon()), Next::frame);
}

TEST_F(RecordReplay, EndsAgainAndAgain) {
    record(1, milliseconds(1));
    const auto source = open(Pace::fastest);
    RawFrame frame;
    ASSERT_EQ(source->next(frame, soon()), Next::frame);
    EXPECT_EQ(source->next(frame, soon()), Next::end);
    EXPECT_EQ(source->next(frame, soon()), Next::end);
}

TEST_F(RecordReplay, ACalibrationFileThatIsMissingIsRefused) {
    record(1, milliseconds(1));
    SourceOptions options;
    options.uri = path_;
    options.calibration_path = folder_.file("missing.conf");
    EXPECT_THROW(open_recording(options), std::invalid_argument);
}

TEST_F(RecordReplay, NoLoansAreRefused) {
    record(1, milliseconds(1));
    EXPECT_THROW(open(Pace::fastest, false, 0), std::invalid_argument);
}

}  // namespace
}  // namespace disparityd::capture::test
