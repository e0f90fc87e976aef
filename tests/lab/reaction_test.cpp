// SPDX-License-Identifier: Apache-2.0
//
// What lab/reaction makes of the frames that a client saw. Nothing is timed here.
#include <gmock/gmock.h>

#include "capture/frame_source.h"
#include "lab/reaction/pole_recording.h"
#include "lab/reaction/reaction_times.h"
#include "tests/temporary_folder.h"

namespace disparityd::reaction {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::int64_t ms = 1'000'000;
constexpr std::int64_t period = 100 * ms;
constexpr int without = 3;
constexpr int with = 2;

/// A source that captures frame 0 at 1000 s; each frame takes `late` until it is received.
struct Client {
    ReactionTimes times{period, without, with};

    void see(std::uint64_t sequence, std::int64_t late, bool shown) {
        const std::int64_t captured = 1'000'000 * ms + static_cast<std::int64_t>(sequence) * period;
        times.add({sequence, captured + late, late - ms, shown});
    }
};

TEST(ReactionTimes, CountFromTheCaptureOfTheFirstFrameWithThePole) {
    Client client;
    for (std::uint64_t i = 0; i < 20; ++i) {
        client.see(i, 30 * ms, i % 5 >= 3);
    }
    EXPECT_EQ(client.times.result().appearances, 2) << "neither the first round nor the last one";
    // The quickest frame needed a millisecond from publishing to receiving: that cannot be told from being older.
    EXPECT_THAT(client.times.result().reactions_ns, ElementsAre(29 * ms, 29 * ms));
    EXPECT_EQ(client.times.result().never_shown, 0);
    EXPECT_EQ(client.times.result().shown_before, 0);
}

TEST(ReactionTimes, ADroppedFrameCountsAsWaiting) {
    Client client;
    for (const std::uint64_t i : {0U, 1U, 2U, 3U, 4U, 5U, 7U, 9U, 10U}) {  // 8 is the first with a pole
        client.see(i, 30 * ms, i % 5 >= 3);
    }
    EXPECT_THAT(client.times.result().reactions_ns, ElementsAre(129 * ms));
}

TEST(ReactionTimes, APoleThatIsNotShownOrWasBefore) {
    Client client;
    for (std::uint64_t i = 0; i < 15; ++i) {
        client.see(i, 30 * ms, i == 6);
    }
    EXPECT_EQ(client.times.result().appearances, 1);
    EXPECT_EQ(client.times.result().never_shown, 1);
    EXPECT_EQ(client.times.result().shown_before, 1);
    EXPECT_THAT(client.times.result().reactions_ns, IsEmpty());
}

TEST(Poles, AScanShowsOneInItsSectorOrTheNext) {
    disparity::Scan scan;
    scan.sectors = {{.from_deg = -10, .to_deg = 0, .state = disparity::SectorState::occupied, .distance_m = 2},
                    {.from_deg = 0, .to_deg = 10, .state = disparity::SectorState::free, .free_m = 5}};
    EXPECT_TRUE(shows(scan, {2.2, -5}));
    EXPECT_TRUE(shows(scan, {2.2, 5})) << "the next one";
    EXPECT_FALSE(shows(scan, {2.2, 15}));
    EXPECT_FALSE(shows(scan, {2.5, -5})) << "another distance";
}

TEST(Poles, TheRecordingHasThemInTheSecondPartOfEachRound) {
    const disparityd::test::TemporaryFolder folder;
    PolePlan plan;
    plan.camera = {160, 120, 90, 0.12, 0.3};
    plan.without = 2;
    plan.with = 1;
    plan.rounds = 2;
    int told = 0;
    const std::vector<Pole> poles = write_pole_recording(folder.file("p.mkv"), plan, [&](int done) { told = done; });
    EXPECT_EQ(told, 2);
    ASSERT_EQ(poles.size(), 2U);
    EXPECT_NE(poles[0].distance_m, poles[1].distance_m);
    capture::SourceOptions options;
    options.uri = folder.file("p.mkv");
    options.pace = capture::Pace::fastest;
    const auto source = capture::open_source(options);
    EXPECT_TRUE(source->info().synthetic);
    ASSERT_TRUE(source->info().calibration);
    std::vector<std::vector<std::uint8_t>> frames;
    capture::RawFrame frame;
    while (source->next(frame, std::chrono::steady_clock::now() + std::chrono::hours(1)) ==
           capture::FrameSource::Next::frame) {
        EXPECT_EQ(frame.sequence, frames.size());
        frames.emplace_back(frame.image.data, frame.image.data + 2 * 160 * 120);
        source->give_back(frame);
    }
    ASSERT_EQ(frames.size(), 6U);
    EXPECT_EQ(frames[0], frames[1]);
    EXPECT_NE(frames[1], frames[2]);
    EXPECT_NE(frames[0], frames[3]) << "another floor";
}

}  // namespace
}  // namespace disparityd::reaction
