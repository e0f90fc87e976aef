// SPDX-License-Identifier: Apache-2.0
//
// Live pipelines: stamps, losses, recovery, interruption.
#include <algorithm>
#include <thread>
#include <tuple>

#include "capture/source_condition.h"
#include "tests/capture/gstreamer/gst_fixture.h"

namespace disparityd::capture {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using std::chrono::steady_clock;
using test::has_element;
using test::options_of;
using test::soon;
using test::test_source;
using test::width;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using Next = FrameSource::Next;

std::int64_t now_ns() {
    return nanoseconds(steady_clock::now().time_since_epoch()).count();
}

TEST(GstLive, FramesHaveTheTimesOfThisMachinesClocks) {
    const std::int64_t before = now_ns();
    const auto source = open_source(options_of(test_source("is-live=true", "100") + "! appsink"));
    EXPECT_TRUE(source->info().live);
    EXPECT_EQ(source->info().rate, 100);
    std::int64_t last = before;
    RawFrame frame;
    for (int i = 0; i < 4; ++i) {
        ASSERT_EQ(source->next(frame, soon()), Next::frame);
        EXPECT_GT(frame.monotonic_ns, last);
        EXPECT_LE(frame.monotonic_ns, now_ns());
        const std::int64_t real = nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
        EXPECT_LE(frame.realtime_ns, real);
        EXPECT_NEAR(static_cast<double>(real - frame.realtime_ns), static_cast<double>(now_ns() - frame.monotonic_ns),
                    5e9);
        last = frame.monotonic_ns;
        source->give_back(frame);
    }
    EXPECT_EQ(source->condition().camera->state, CameraState::streaming);
}

TEST(GstLive, EyesOfTwoSinksArePairedByStamp) {
    const auto source =
        open_source(options_of(test_source("is-live=true pattern=white", "100", width) + "! appsink name=left " +
                               test_source("is-live=true pattern=black", "100", width) + "! appsink name=right"));
    RawFrame frame;
    for (int i = 0; i < 3; ++i) {
        ASSERT_EQ(source->next(frame, soon()), Next::frame);
        EXPECT_GT(frame.image.data[width - 1], 200) << "left";
        EXPECT_LT(frame.image.data[width], 50) << "right";
        source->give_back(frame);
    }
}

TEST(GstLive, EyesWhoseStampsLieInTheFutureArePairedByThemAndThatIsTold) {
    // The source that is live makes the pipeline so; `sync` lets pictures go 200 ms before their times.
    const std::string eye = "pattern=ball animation-mode=frames";
    const std::string early = "! identity sync=true ts-offset=-200000000 ";
    SourceOptions options = options_of("videotestsrc is-live=true ! fakesink " + test_source(eye, "100", width) +
                                       early + "! appsink name=left " + test_source(eye, "100", width) + early +
                                       "! queue max-size-buffers=0 min-threshold-time=100000000 ! appsink name=right");
    const auto source = open_source(options);
    ASSERT_TRUE(source->info().live);
    RawFrame frame;
    for (int i = 0; i < 12; ++i) {
        ASSERT_EQ(source->next(frame, soon()), Next::frame);
        EXPECT_LE(frame.monotonic_ns, now_ns());
        for (int y = 0; y < frame.image.height; ++y) {
            const std::uint8_t* const row = frame.image.data + y * frame.image.stride;
            ASSERT_TRUE(std::equal(row, row + width, row + width)) << "other instants in frame " << i;
        }
        source->give_back(frame);
    }
    EXPECT_THAT(source->condition().notices, Contains(HasSubstr("lie in the future")));
}

TEST(GstLive, FramesThatNobodyTakesInTimeAreCounted) {
    SourceOptions options = options_of(test_source("is-live=true", "200") + "! appsink");
    options.loans = 1;
    const auto source = open_source(options);
    RawFrame held;
    ASSERT_EQ(source->next(held, soon()), Next::frame);
    std::uint32_t lost = 0;
    for (int i = 0; i < 200 && lost == 0; ++i) {
        RawFrame frame;
        EXPECT_EQ(source->next(frame, steady_clock::now() + milliseconds(40)), Next::timeout) << "all loans are out";
        const std::uint64_t before = held.sequence;
        source->give_back(held);
        ASSERT_EQ(source->next(held, soon()), Next::frame);
        lost = held.dropped_before;
        EXPECT_EQ(held.sequence, before + lost + 1);
        // What waits was taken before; the next ones show what was dropped behind them.
    }
    EXPECT_GT(lost, 0U);
    source->give_back(held);
}

TEST(GstLive, AnInterruptionEndsAWaitAndThePipeline) {
    SourceOptions options = options_of(test_source("is-live=true", "100") + "! appsink");
    options.loans = 1;
    const auto source = open_source(options);
    RawFrame frame;
    ASSERT_EQ(source->next(frame, soon()), Next::frame);
    std::thread other([&] { source->interrupt(); });
    RawFrame none;
    EXPECT_EQ(source->next(none, soon()), Next::interrupted);
    EXPECT_EQ(source->next(none, soon()), Next::interrupted);
    other.join();
    source->give_back(frame);
}

TEST(GstLive, WithoutADaemonTheEndOfThePipelineIsTheEnd) {
    const auto source = open_source(options_of(test_source("is-live=true num-buffers=12", "100") + "! appsink"));
    RawFrame frame;
    Next got = source->next(frame, soon());
    for (; got == Next::frame; got = source->next(frame, soon())) {
        source->give_back(frame);
    }
    EXPECT_EQ(got, Next::end);
    EXPECT_EQ(source->next(frame, soon()), Next::end);
}

TEST(GstLive, ForADaemonAPipelineThatEndsIsStartedAnew) {
    std::vector<std::string> lines;
    SourceOptions options = options_of(test_source("is-live=true num-buffers=4", "100") + "! appsink");
    options.wait_for_camera = true;
    options.report = [&](const std::string& line, bool) { lines.push_back(line); };
    const auto source = open_source(options);
    RawFrame frame;
    std::uint64_t expected = 0;
    bool anew = false;
    for (int calls = 0; calls < 10'000 && !anew; ++calls) {
        if (source->next(frame, steady_clock::now() + milliseconds(20)) == Next::frame) {
            EXPECT_EQ(frame.sequence, expected++ + frame.dropped_before);
            anew = (frame.flags & frame_flag_discontinuity) != 0;
            source->give_back(frame);
        } else if (!source->condition().delivering) {
            EXPECT_THAT(source->condition().detail, HasSubstr("the pipeline has ended; it is started anew"));
        }
    }
    EXPECT_TRUE(anew);
    EXPECT_GE(source->condition().camera->restarts, 1U);
    EXPECT_THAT(lines, Contains(HasSubstr("the pipeline has ended")));
}

TEST(GstLive, AStallAndAnErrorAreTold) {
    for (const auto& [element, told, stall_ms] :
         {std::tuple("identity sleep-time=150000", "no frame has come for", 60),
          std::tuple("identity name=wire error-after=3", "wire: Failed after iterations", 2000)}) {
        SourceOptions options = options_of(test_source("is-live=true", "100") + "! " + element + " ! appsink");
        options.stall_time = milliseconds(stall_ms);
        const test::Played played = test::play_all(options);
        EXPECT_THAT(played.problem, HasSubstr(told));
    }
}

TEST(GstLive, ADaemonWaitsForADeviceAndTellsWhyOnce) {
    struct Cancelled {};
    std::vector<std::string> lines;
    SourceOptions options = options_of("v4l2src device=/dev/video77 ! appsink");
    options.wait_for_camera = true;
    options.stall_time = milliseconds(20);
    options.report = [&](const std::string& line, bool) { lines.push_back(line); };
    const auto until = steady_clock::now() + milliseconds(100);
    options.progress = [&](int, int) {
        if (steady_clock::now() >= until) {
            throw Cancelled();
        }
    };
    if (has_element("v4l2src")) {
        EXPECT_THROW(open_source(options), Cancelled);
        EXPECT_THAT(lines, ElementsAre(HasSubstr("Cannot identify device '/dev/video77'")));
    }
    lines.clear();
    options.progress = [](int, int) {};
    options.uri = "gst:filesrc location=/nowhere ! rawvideoparse width=128 height=48 ! appsink";
    EXPECT_THROW(open_source(options), std::runtime_error);
    EXPECT_TRUE(lines.empty()) << "a file is not waited for";
}

TEST(GstLive, AnotherSizeAsksADaemonToOpenTheSourceAnew) {
    SourceOptions options = options_of("concat name=c ! appsink " + test_source("is-live=true num-buffers=2", "50") +
                                       "! c. " + test_source("is-live=true", "50", 4 * width) + "! c.");
    options.wait_for_camera = true;
    const auto source = open_source(options);
    RawFrame frame;
    for (int calls = 0; calls < 10'000 && !source->condition().reopen; ++calls) {
        if (source->next(frame, steady_clock::now() + milliseconds(20)) == Next::frame) {
            EXPECT_EQ(frame.image.eye_width, width);
            source->give_back(frame);
        }
    }
    EXPECT_TRUE(source->condition().reopen);
    EXPECT_THAT(source->condition().detail, HasSubstr("128x48"));
}

TEST(GstLive, AnotherSizeOfOneOfTwoEyesAsksADaemonToOpenTheSourceAnew) {
    SourceOptions options =
        options_of(test_source("is-live=true", "50", width) + "! appsink name=left " +
                   "concat name=c ! appsink name=right " + test_source("is-live=true num-buffers=9", "50", width) +
                   "! c. " + test_source("is-live=true", "50", 2 * width) + "! c.");
    options.wait_for_camera = true;
    const auto source = open_source(options);
    RawFrame frame;
    for (int calls = 0; calls < 10'000 && !source->condition().reopen; ++calls) {
        if (source->next(frame, steady_clock::now() + milliseconds(20)) == Next::frame) {
            source->give_back(frame);
        }
    }
    EXPECT_TRUE(source->condition().reopen);
    EXPECT_THAT(source->condition().detail, HasSubstr("change from 64x48 grey8 to 128x48 grey8 per eye"));
}

TEST(GstLive, ADaemonNeedsACalibrationUnlessItMayDoWithout) {
    SourceOptions options = options_of(test_source("is-live=true", "100") + "! appsink");
    options.allow_unrectified = false;
    EXPECT_THAT(test::refusal([&] { open_source(options); }), HasSubstr("a pipeline has no calibration"));
    options.controls = "gain=3";
    EXPECT_THAT(test::refusal([&] { open_source(options); }), HasSubstr("set them in the pipeline"));
}

}  // namespace
}  // namespace disparityd::capture
