// SPDX-License-Identifier: Apache-2.0
//
// What --check tells of a frame is what frames take then. Both are processor time, which other programs do not take.
#include <condition_variable>
#include <filesystem>
#include <mutex>

#include <gtest/gtest.h>

#include "capture/recording/recording_writer.h"
#include "daemon/engine.h"
#include "tests/temporary_folder.h"

namespace disparityd::daemon {
namespace {

using Seconds = FrameCost::Seconds;

/// Little of the work is matching.
Config config_of_little_matching() {
    Config config;
    config.source.uri = "scene:vga@30?width=320&height=240&loop=4";
    config.source.pace = capture::Pace::fastest;
    config.source.policy = PolicyChoice::replay;
    config.match.backend = "cpu";
    config.match.options.method = Method::sad;
    config.match.options.range.count = 16;
    config.rectify.colour = config.rectify.right = config.rectify.raw = true;
    config.self_calibration.enabled = false;
    config.pipeline.workers = 1;
    return config;
}

/// The processor time of a frame, its source's with it, while an engine runs: the least of some averages, as other
/// programs make frames dearer.
Seconds while_it_runs(const Config& config) {
    constexpr int first = 20, step = 20, last = 120;
    std::mutex mutex;
    std::condition_variable done;
    std::chrono::nanoseconds begin{};
    Seconds least = Seconds::max();
    int count = 0;
    std::vector<std::uint8_t> copy;
    Engine engine(config, {}, {});
    engine.start(
        [&](const PublishedFrame& frame) {
            for (const auto& plane : frame.planes) {
                copy.assign(plane.data, plane.data + plane.stride * plane.height);
            }
            const std::lock_guard lock(mutex);
            if (++count % step == 0) {
                const std::chrono::nanoseconds now = pipeline::processor_time();
                least = count > first ? std::min(least, Seconds(now - begin) / step) : least;
                begin = now;
            }
            done.notify_one();
        },
        [](const capture::RawFrame&) {}, [] { return true; }, 0);
    std::unique_lock lock(mutex);
    EXPECT_TRUE(done.wait_for(lock, std::chrono::minutes(2), [&] { return count >= last; }));
    lock.unlock();
    engine.stop();
    return least;
}

TEST(EngineTrial, AFrameCostsWhatItIsToldToCost) {
    const Config config = config_of_little_matching();
    const Seconds real = while_it_runs(config);
    const FrameCost cost = Engine(config, {}, {}).cost_of_frame();
    EXPECT_TRUE(cost.of_source);
    ASSERT_TRUE(cost.taken);
    const Seconds told = cost.used + *cost.taken;
    EXPECT_GT(told / real, 0.5) << "work is left out: " << told.count() << " s told, " << real.count() << " s taken";
    EXPECT_LT(told / real, 4) << told.count() << " s told, " << real.count() << " s taken";
    EXPECT_GT(cost.passes.count(), 0);
}

TEST(EngineTrial, ASourceThatCannotBeReadIsTold) {
    const test::TemporaryFolder folder;
    Config config = config_of_little_matching();
    capture::SourceOptions drawn;
    drawn.uri = config.source.uri;
    drawn.pace = capture::Pace::fastest;
    const auto source = capture::open_source(drawn);
    config.source.uri = folder.file("cut.mkv");
    capture::RecordingWriter writer(config.source.uri, source->info());
    capture::RawFrame frame;
    ASSERT_EQ(source->next(frame, std::chrono::steady_clock::now() + std::chrono::minutes(1)),
              capture::FrameSource::Next::frame);
    writer.write(frame);
    source->give_back(frame);
    writer.close();
    std::filesystem::resize_file(config.source.uri, std::filesystem::file_size(config.source.uri) / 2);
    const FrameCost cost = Engine(config, {}, {}).cost_of_frame();
    EXPECT_FALSE(cost.of_source);
    EXPECT_NE(cost.unread, "");
}

TEST(EngineTrial, ACameraIsLeftAlone) {
    Config config = config_of_little_matching();
    config.source.uri = "v4l2:vga@30?serial=1";
    config.source.policy = PolicyChoice::automatic;
    const FrameCost cost = Engine(config, {}, {}).cost_of_frame();
    EXPECT_FALSE(cost.of_source);
    EXPECT_FALSE(cost.taken);
    EXPECT_GT(cost.used.count(), 0);
}

}  // namespace
}  // namespace disparityd::daemon
