// SPDX-License-Identifier: Apache-2.0
#include <condition_variable>
#include <mutex>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/engine.h"
#include "tests/emulation/with_settings.h"

// The daemon's engine on a GPU that is lost in mid-stream.
namespace disparityd::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr std::size_t frames = 8;

daemon::Config config_for(const std::string& backend) {
    daemon::Config config;
    config.source.uri = "scene:vga@15?width=64&height=40&loop=3&frames=8";
    config.source.pace = capture::Pace::fastest;
    config.source.policy = daemon::PolicyChoice::replay;
    config.match.backend = backend;
    config.match.options = default_options(Method::census, {0, 16});
    config.pipeline.workers = 1;
    return config;
}

struct Outcome {
    std::vector<std::uint64_t> numbers;
    std::vector<std::vector<std::uint8_t>> disparities;
    v1::Status before, after;
};

Outcome outcome_of(const std::string& backend) {
    daemon::Engine engine(config_for(backend), {}, [](int, int) {});
    Outcome outcome;
    engine.fill(outcome.before);
    std::mutex mutex;
    std::condition_variable arrived;
    const auto keep = [&](const daemon::PublishedFrame& frame) {
        const std::lock_guard lock(mutex);
        outcome.numbers.push_back(frame.info.sequence);
        std::vector<std::uint8_t>& bytes = outcome.disparities.emplace_back();
        for (int y = 0; y < frame.planes[0].height; ++y) {
            bytes.insert(bytes.end(), frame.planes[0].row(y), frame.planes[0].row(y) + frame.planes[0].width);
        }
        arrived.notify_one();
    };
    const auto always = [] { return true; };
    engine.start(
        keep, [](const capture::RawFrame&) {}, always, 0);
    {
        std::unique_lock lock(mutex);
        arrived.wait_for(lock, std::chrono::seconds(200), [&] { return outcome.numbers.size() == frames; });
    }
    engine.stop();
    engine.fill(outcome.after);
    return outcome;
}

TEST(EmulatedCudaEngine, StatusNamesTheBackEndThatComputesAndWhy) {
    simt::Machine failing;
    failing.operations_until_lost = 60;  // in the third frame or so
    const WithMachine machine(failing);
    const Outcome found = outcome_of("auto");
    EXPECT_EQ(found.before.backend(), "cuda");
    EXPECT_EQ(found.after.backend(), "cpu");
    EXPECT_THAT(found.after.detail(), AllOf(HasSubstr("launch failure"), HasSubstr("back end cpu goes on")));
    EXPECT_THAT(found.numbers, testing::ElementsAre(0, 1, 2, 3, 4, 5, 6, 7));
    EXPECT_EQ(found.disparities, outcome_of("reference").disparities);
}

TEST(EmulatedCudaEngine, StatusNamesTheSubstituteWhereTheDeviceHasTooLittleMemory) {
    simt::Machine small;
    small.memory = 10000;
    const WithMachine machine(small);
    const daemon::Engine engine(config_for("auto"), {}, [](int, int) {});
    v1::Status status;
    engine.fill(status);
    EXPECT_EQ(status.backend(), "cpu");
}

TEST(EmulatedCudaEngine, NothingIsSubstitutedWhereAllIsWell) {
    const Outcome found = outcome_of("auto");
    EXPECT_EQ(found.after.backend(), "cuda");
    EXPECT_THAT(found.after.detail(), testing::Not(HasSubstr("goes on")));
}

}  // namespace
}  // namespace disparityd::test
