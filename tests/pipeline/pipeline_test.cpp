// SPDX-License-Identifier: Apache-2.0
#include "pipeline/pipeline.h"

#include <optional>
#include <semaphore>
#include <span>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "pipeline/core_budget.h"
#include "tests/pipeline/fakes.h"

namespace disparityd::pipeline {
namespace {

using namespace std::chrono_literals;

// What the sink saw of a frame.
struct Seen {
    std::uint64_t sequence;
    std::uint64_t dropped_before;
    int disparity;
};

struct Sink {
    std::vector<Seen> frames;
    Pipeline::Sink function() {
        return [this](const FrameSlot& slot) {
            frames.push_back({slot.raw.sequence, slot.dropped_before, slot.view.disparity.at(0, 0)});
        };
    }
};

/// A pipeline over the test's source and matcher, with all else that it borrows.
struct Chain {
    Chain(const PipelineConfig& config, fakes::Source& source, fakes::Matcher& matcher, int worker_count,
          Pipeline::RawTap tap = {})
        : workers(worker_count),
          pipeline(config, source, matcher, workers, rectification, sink.function(), std::move(tap)) {}

    WorkerPool workers;
    const calibration::Rectification rectification = fakes::rectification();
    Sink sink;
    Pipeline pipeline;
};

using fakes::forever;

/// Another rectification for every frame, numbered as the frame is.
class NumberedRectifications final : public RectificationSchedule {
public:
    const calibration::Rectification& factory() const override { return first_; }
    std::shared_ptr<const calibration::Rectification> for_frame(capture::RawFrame& frame) override {
        frame.correction.pitch_nrad = static_cast<std::int32_t>(frame.sequence);
        auto numbered = std::make_shared<calibration::Rectification>(first_);
        numbered->calibration_id = frame.sequence;
        return numbered;
    }

private:
    const calibration::Rectification first_ = fakes::rectification();
};

/// Frames of 10 per second, each with 20 samples of a camera that nods more with each frame.
std::vector<std::optional<SensorDirection>> ups_of_nodding(Policy policy) {
    constexpr std::int64_t frame_ns = 100'000'000;
    constexpr std::size_t frames = 12;
    std::vector<std::vector<capture::SensorSample>> samples(frames, std::vector<capture::SensorSample>(20));
    fakes::Source source;
    for (std::size_t i = 0; i < frames; ++i) {
        const auto begin = static_cast<std::int64_t>(i) * frame_ns;
        for (std::size_t j = 0; j < samples[i].size(); ++j) {
            samples[i][j].flags = capture::sensor_flag_inertial;
            samples[i][j].monotonic_ns = begin + static_cast<std::int64_t>(j) * frame_ns / 20;
            samples[i][j].acceleration = {0.2F * static_cast<float>(i), -9.8F, 0};
        }
        source.push(i, begin + frame_ns, i == 7 ? std::span<const capture::SensorSample>() : samples[i]);
    }
    source.end();
    fakes::Matcher matcher;
    WorkerPool workers(1);
    const calibration::Rectification rectification = fakes::rectification();
    std::vector<std::optional<SensorDirection>> ups(frames);
    Pipeline pipeline({.policy = policy}, source, matcher, workers, rectification,
                      [&ups](const FrameSlot& slot) { ups.at(slot.raw.sequence) = slot.up; });
    pipeline.start();
    EXPECT_TRUE(pipeline.wait_until_ended(forever));
    return ups;
}

TEST(Pipeline, EachFrameKnowsWhereUpIsFromAllSamplesBeforeIt) {
    const auto replayed = ups_of_nodding(Policy::replay);
    EXPECT_FALSE(replayed.front()) << "95 ms of samples are too few";
    double before = -1;
    for (std::size_t i = 1; i < replayed.size(); ++i) {
        ASSERT_TRUE(replayed[i]) << i;
        const double lean = replayed[i]->x / -replayed[i]->y;
        if (i != 7) {
            EXPECT_GT(lean, before) << i;
        } else {
            EXPECT_EQ(lean, before) << "that frame brought none";
        }
        before = lean;
    }
    EXPECT_EQ(ups_of_nodding(Policy::replay), replayed) << "the same each time";
    // Frames that are dropped have brought their samples, too.
    const auto live = ups_of_nodding(Policy::live);
    int published = 0;
    for (std::size_t i = 0; i < live.size(); ++i) {
        published += live[i] ? 1 : 0;
        EXPECT_TRUE(!live[i] || live[i] == replayed[i]) << i;
    }
    EXPECT_GE(published, 1);
}

// Also where newer frames take the place of older ones.
TEST(Pipeline, EachFrameKeepsTheRectificationThatItWasGiven) {
    for (const Policy policy : {Policy::replay, Policy::live}) {
        fakes::Source source(500);
        std::vector<std::uint64_t> used;
        fakes::Matcher matcher([&used](int stage, const FrameView& view) {
            if (stage == 0) {
                used.push_back(view.rectifier->id);
            }
        });
        NumberedRectifications rectifications;
        WorkerPool workers(2);
        std::vector<std::uint64_t> tapped;
        std::vector<std::uint64_t> published;
        Pipeline pipeline(
            {.policy = policy, .slots = 3}, source, matcher, workers, rectifications,
            [&published](const FrameSlot& slot) {
                EXPECT_EQ(slot.rectification->calibration_id, slot.raw.sequence);
                EXPECT_EQ(slot.raw.correction.pitch_nrad, static_cast<std::int32_t>(slot.raw.sequence));
                published.push_back(slot.raw.sequence);
            },
            [&tapped](const capture::RawFrame& frame) {
                EXPECT_EQ(frame.correction.pitch_nrad, static_cast<std::int32_t>(frame.sequence));
                tapped.push_back(frame.sequence);
            });
        pipeline.start();
        ASSERT_TRUE(pipeline.wait_until_ended(forever));
        pipeline.stop();
        EXPECT_EQ(used, published);
        EXPECT_EQ(tapped.size(), 500U);
        EXPECT_EQ(policy == Policy::replay ? published.size() : 500U, 500U);
        EXPECT_EQ(published.back(), 499U);
    }
}

TEST(Pipeline, ReplayKeepsEveryFrameInOrder) {
    fakes::Source source(200);
    fakes::Matcher matcher;
    Chain chain({.policy = Policy::replay, .slots = 3}, source, matcher, 2);
    chain.pipeline.start();
    ASSERT_TRUE(chain.pipeline.wait_until_ended(forever));
    ASSERT_EQ(chain.sink.frames.size(), 200U);
    for (std::size_t i = 0; i < chain.sink.frames.size(); ++i) {
        EXPECT_EQ(chain.sink.frames[i].sequence, i);
        EXPECT_EQ(chain.sink.frames[i].disparity, static_cast<int>(i % 256));
        EXPECT_EQ(chain.sink.frames[i].dropped_before, 0U);
    }
    const PipelineStatus status = chain.pipeline.status();
    EXPECT_EQ(status.captured, 200U);
    EXPECT_EQ(status.published, 200U);
    EXPECT_EQ(status.dropped, 0U);
    EXPECT_TRUE(status.ended);
    EXPECT_EQ(status.error, "");
    ASSERT_EQ(status.steps.size(), 8U);
    EXPECT_EQ(status.steps[0].name, "capture");
    EXPECT_EQ(status.steps[1].name, "wait-start");
    EXPECT_EQ(status.steps[3].name, "dsi");
    EXPECT_EQ(status.steps[5].name, "wait-between");
    EXPECT_EQ(status.steps[7].name, "total");
    for (const PipelineStatus::Step& step : status.steps) {
        EXPECT_EQ(step.time.count, 200U) << step.name;
    }
    chain.pipeline.stop();
    EXPECT_EQ(source.out(), 0U);
    EXPECT_EQ(source.wrong_returns(), 0);
}

// Asked all the time, so that the question and the end meet in every order.
TEST(Pipeline, AStatusOfTheEndCountsEveryFrame) {
    for (int run = 0; run < 300; ++run) {
        fakes::Source source(3);
        fakes::Matcher matcher;
        Chain chain({.policy = Policy::replay, .slots = 3}, source, matcher, 1);
        chain.pipeline.start();
        PipelineStatus status;
        while (!status.ended) {
            status = chain.pipeline.status();
        }
        ASSERT_EQ(status.published, 3U) << "run " << run;
    }
}

// One that waited behind another would be older than the newest by then.
TEST(Pipeline, OneWorkerBeginsTheNewestFrameWhenItIsDoneWithTheOneBefore) {
    std::counting_semaphore<> gate(0);
    std::binary_semaphore entered(0);
    std::vector<std::pair<int, std::uint8_t>> runs;
    fakes::Source source;
    fakes::Matcher matcher([&](int stage, const FrameView& view) {
        runs.emplace_back(stage, stage == 0 ? view.raw.data[0] : 0);
        entered.release();
        gate.acquire();
    });
    Chain chain({.policy = Policy::live, .slots = 4}, source, matcher, 1);
    chain.pipeline.start();
    source.push(0);
    entered.acquire();
    gate.release();
    entered.acquire();  // the second stage has the first frame, and the first stage would be free
    for (std::uint64_t i = 1; i < 6; ++i) {
        source.push(i);
        while (chain.pipeline.status().captured <= i) {
            std::this_thread::yield();
        }
    }
    EXPECT_EQ(runs.size(), 2U);
    source.end();
    gate.release(100);
    ASSERT_TRUE(chain.pipeline.wait_until_ended(forever));
    ASSERT_GE(runs.size(), 4U);
    EXPECT_EQ(runs[2], std::pair(0, std::uint8_t{5}));
    EXPECT_EQ(chain.pipeline.status().published, 2U);
    EXPECT_EQ(chain.pipeline.status().dropped, 4U);
}

// With the matcher held, live frames pile up; the newest must win and every loss be counted.
TEST(Pipeline, LiveDropsTheOldestAndCounts) {
    std::counting_semaphore<> gate(0);
    std::binary_semaphore entered(0);
    std::atomic<bool> first{true};
    fakes::Source source;
    fakes::Matcher matcher([&](int stage, const FrameView&) {
        if (stage == 0) {
            if (first.exchange(false)) {
                entered.release();
            }
            gate.acquire();
        }
    });
    Chain chain({.policy = Policy::live, .slots = 4}, source, matcher, 1);
    chain.pipeline.start();
    source.push(0);
    entered.acquire();
    for (std::uint64_t sequence = 1; sequence <= 20; ++sequence) {
        source.push(sequence, sequence == 7 ? 3 : 0);
    }
    while (chain.pipeline.status().captured < 21) {
        std::this_thread::yield();
    }
    source.end();
    gate.release(100);
    ASSERT_TRUE(chain.pipeline.wait_until_ended(forever));
    ASSERT_EQ(chain.sink.frames.size(), 2U);
    EXPECT_EQ(chain.sink.frames[0].sequence, 0U);
    EXPECT_EQ(chain.sink.frames[1].sequence, 20U);
    EXPECT_EQ(chain.sink.frames[1].dropped_before, 19U + 3U);
    const PipelineStatus status = chain.pipeline.status();
    EXPECT_EQ(status.dropped, 19U);
    EXPECT_EQ(status.lost, 3U);
    EXPECT_EQ(status.published, 2U);
    EXPECT_EQ(source.out(), 0U);
    EXPECT_EQ(source.wrong_returns(), 0);
}

TEST(Pipeline, LiveAccountsForEveryFrameUnderLoad) {
    fakes::Source source;
    fakes::Matcher matcher([](int, const FrameView&) { std::this_thread::yield(); });
    Chain chain({.policy = Policy::live, .slots = 2}, source, matcher, 2);
    chain.pipeline.start();
    for (std::uint64_t sequence = 0; sequence < 2000; ++sequence) {
        while (source.in_use() > 50) {
            std::this_thread::yield();
        }
        source.push(sequence);
    }
    source.end();
    ASSERT_TRUE(chain.pipeline.wait_until_ended(forever));
    std::uint64_t accounted = 0;
    for (const Seen& seen : chain.sink.frames) {
        accounted += 1 + seen.dropped_before;
        EXPECT_EQ(accounted, seen.sequence + 1);
        EXPECT_EQ(seen.disparity, static_cast<int>(seen.sequence % 256));
    }
    EXPECT_EQ(accounted, 2000U) << "the last frame is never dropped";
    EXPECT_EQ(chain.pipeline.status().dropped + chain.pipeline.status().published, 2000U);
    EXPECT_EQ(source.out(), 0U);
}

// Counted in frames: the first one that comes after somebody wants frames is published.
TEST(Pipeline, FramesThatNobodyWantsAreCapturedAndNotProcessed) {
    std::atomic<bool> wanted{false};
    std::atomic<int> begun{0};
    std::atomic<int> tapped{0};
    fakes::Source source;
    fakes::Matcher matcher([&](int stage, const FrameView&) { begun += stage == 0 ? 1 : 0; });
    Chain chain({.policy = Policy::live, .slots = 2, .wanted = [&] { return wanted.load(); }}, source, matcher, 1,
                [&](const capture::RawFrame&) { ++tapped; });
    chain.pipeline.start();
    const auto status_when = [&](const std::function<bool(const PipelineStatus&)>& it_is_so) {
        PipelineStatus status = chain.pipeline.status();
        while (!it_is_so(status)) {
            std::this_thread::yield();
            status = chain.pipeline.status();
        }
        return status;
    };
    for (std::uint64_t sequence = 0; sequence < 10; ++sequence) {
        source.push(sequence);
    }
    const PipelineStatus idle = status_when([](const PipelineStatus& now) { return now.unwanted == 10; });
    EXPECT_EQ(idle.captured, 10U);
    EXPECT_EQ(idle.published + idle.dropped + idle.damaged, 0U);
    EXPECT_EQ(begun.load(), 0);
    EXPECT_EQ(tapped.load(), 10) << "a recording gets them";
    EXPECT_EQ(source.out(), 0U);
    wanted = true;
    source.push(10);
    status_when([](const PipelineStatus& now) { return now.published == 1; });
    wanted = false;
    source.push(11);
    source.push(12);
    status_when([](const PipelineStatus& now) { return now.unwanted == 12; });
    wanted = true;
    source.push(13);
    source.end();
    ASSERT_TRUE(chain.pipeline.wait_until_ended(forever));
    ASSERT_EQ(chain.sink.frames.size(), 2U);
    EXPECT_EQ(chain.sink.frames[0].sequence, 10U);
    EXPECT_EQ(chain.sink.frames[0].dropped_before, 10U);
    EXPECT_EQ(chain.sink.frames[1].sequence, 13U);
    EXPECT_EQ(chain.sink.frames[1].dropped_before, 2U);
    EXPECT_EQ(begun.load(), 2);
    EXPECT_EQ(chain.pipeline.status().dropped, 0U);
    EXPECT_EQ(source.out(), 0U);
    EXPECT_EQ(source.wrong_returns(), 0);
}

/// A budget of one core. Each frame costs a second of processor time, and half a second passes with each question.
struct MadeBudget {
    std::atomic<int> worked{0};  ///< frames
    CoreBudget::Time now{std::chrono::hours(1)};
    int asked = 0;
    CoreBudget budget{1.0, [this] {
                          ++asked;
                          now += std::chrono::milliseconds(500);
                          return CoreBudget::Moment{now, std::chrono::seconds(worked.load())};
                      }};
    fakes::Matcher matcher{[this](int stage, const FrameView&) { worked += stage == 0 ? 1 : 0; }};
};

TEST(Pipeline, LiveFramesBeyondTheBudgetAreLeftOut) {
    MadeBudget made;
    fakes::Source source;
    Chain chain({.policy = Policy::live, .slots = 2, .budget = &made.budget}, source, made.matcher, 1);
    chain.pipeline.start();
    constexpr std::uint64_t frames = 40;
    for (std::uint64_t sequence = 0; sequence < frames; ++sequence) {
        source.push(sequence);
        PipelineStatus now = chain.pipeline.status();
        while (now.published + now.over_budget <= sequence) {
            std::this_thread::yield();
            now = chain.pipeline.status();
        }
    }
    source.end();
    ASSERT_TRUE(chain.pipeline.wait_until_ended(forever));
    const PipelineStatus status = chain.pipeline.status();
    EXPECT_EQ(status.published + status.over_budget, frames);
    EXPECT_GE(status.published, frames / 2 - 3);
    EXPECT_LE(status.published, frames / 2 + 3);
    std::uint64_t accounted = 0;
    for (const Seen& seen : chain.sink.frames) {
        accounted += 1 + seen.dropped_before;
        EXPECT_EQ(accounted, seen.sequence + 1) << "clients learn of the gap";
    }
    EXPECT_EQ(source.out(), 0U);
    EXPECT_EQ(source.wrong_returns(), 0);
}

TEST(Pipeline, AReplayWaitsForItsBudget) {
    MadeBudget made;
    constexpr int frames = 8;
    fakes::Source source(frames);
    Chain chain({.policy = Policy::replay, .slots = 2, .budget = &made.budget}, source, made.matcher, 1);
    chain.pipeline.start();
    ASSERT_TRUE(chain.pipeline.wait_until_ended(forever));
    EXPECT_EQ(chain.pipeline.status().published, static_cast<std::uint64_t>(frames));
    EXPECT_EQ(chain.pipeline.status().over_budget, 0U);
    EXPECT_GT(made.asked, frames);
}

TEST(Pipeline, CorruptFramesAreCountedNotShown) {
    fakes::Source source;
    fakes::Matcher matcher;
    Chain chain({.policy = Policy::replay, .slots = 2}, source, matcher, 1);
    source.push(0);
    source.push(1, 0, capture::frame_flag_corrupt);
    source.push(2);
    source.end();
    chain.pipeline.start();
    ASSERT_TRUE(chain.pipeline.wait_until_ended(forever));
    ASSERT_EQ(chain.sink.frames.size(), 2U);
    EXPECT_EQ(chain.sink.frames[1].sequence, 2U);
    EXPECT_EQ(chain.sink.frames[1].dropped_before, 1U);
    EXPECT_EQ(chain.pipeline.status().damaged, 1U);
    EXPECT_EQ(source.out(), 0U);
}

TEST(Pipeline, ASourceThatFailsLosesNothingThatCameBefore) {
    fakes::Source source;
    fakes::Matcher matcher;
    Chain chain({.policy = Policy::replay, .slots = 2}, source, matcher, 1);
    for (std::uint64_t sequence = 0; sequence < 3; ++sequence) {
        source.push(sequence);
    }
    source.fail();
    chain.pipeline.start();
    ASSERT_TRUE(chain.pipeline.wait_until_ended(forever));
    EXPECT_EQ(chain.sink.frames.size(), 3U);
    EXPECT_EQ(chain.pipeline.status().error, "fake.mkv: truncated after 3 frames");
}

TEST(Pipeline, ASinkThatFailsEndsThePipeline) {
    fakes::Source source(100);
    fakes::Matcher matcher;
    WorkerPool workers(1);
    const calibration::Rectification rectification = fakes::rectification();
    int frames = 0;
    Pipeline pipeline({.policy = Policy::replay, .slots = 2}, source, matcher, workers, rectification,
                      [&](const FrameSlot&) {
                          if (++frames == 5) {
                              throw std::runtime_error("out/000004.png: no space left on device");
                          }
                      });
    pipeline.start();
    ASSERT_TRUE(pipeline.wait_until_ended(forever));
    EXPECT_EQ(frames, 5);
    const PipelineStatus status = pipeline.status();
    EXPECT_EQ(status.published, 4U);
    EXPECT_EQ(status.captured, status.published + status.dropped) << "none is forgotten";
    EXPECT_EQ(status.error, "out/000004.png: no space left on device");
    EXPECT_EQ(source.out(), 0U);
}

TEST(Pipeline, AStageThatFailsEndsThePipeline) {
    fakes::Source source(100);
    fakes::Matcher matcher([](int stage, const FrameView& frame) {
        if (stage == 1 && frame.left.at(0, 0) == 9) {
            throw std::runtime_error("device lost");
        }
    });
    Chain chain({.policy = Policy::replay, .slots = 3}, source, matcher, 2);
    chain.pipeline.start();
    ASSERT_TRUE(chain.pipeline.wait_until_ended(forever));
    const PipelineStatus status = chain.pipeline.status();
    EXPECT_EQ(status.error, "device lost");
    EXPECT_LE(status.published, 9U);
    EXPECT_EQ(status.captured, status.published + status.dropped) << "none is forgotten";
    EXPECT_EQ(source.out(), 0U);
}

TEST(Pipeline, StopsWhileWaitingForFrames) {
    fakes::Source source;
    fakes::Matcher matcher;
    Chain chain({.policy = Policy::live, .slots = 2}, source, matcher, 2);
    chain.pipeline.start();
    source.push(1);
    chain.pipeline.stop();
    chain.pipeline.stop();
    EXPECT_TRUE(chain.pipeline.status().ended);
    EXPECT_EQ(source.out(), 0U);
}

// The second stage is held, so that both slots are busy and the third frame waits for one.
TEST(Pipeline, AFrameThatWaitsWhenThePipelineStopsCountsAsDropped) {
    for (const Policy policy : {Policy::live, Policy::replay}) {
        std::counting_semaphore<> gate(0);
        fakes::Source source;
        fakes::Matcher matcher([&](int stage, const FrameView&) {
            if (stage == 1) {
                gate.acquire();
            }
        });
        Chain chain({.policy = policy, .slots = 2}, source, matcher, 2);
        chain.pipeline.start();
        for (std::uint64_t sequence = 0; sequence < 3; ++sequence) {
            source.push(sequence);
            while (chain.pipeline.status().captured <= sequence || source.out() > sequence / 2) {
                std::this_thread::yield();  // until it is rectified, or waits
            }
        }
        std::thread stopper([&] { chain.pipeline.stop(); });
        while (source.out() > 0) {
            std::this_thread::yield();
        }
        gate.release(100);
        stopper.join();
        const PipelineStatus status = chain.pipeline.status();
        EXPECT_EQ(status.captured, 3U);
        EXPECT_EQ(status.published, 2U);
        EXPECT_EQ(status.dropped, 1U);
        EXPECT_EQ(source.wrong_returns(), 0);
    }
}

TEST(Pipeline, TellsWhichStageIsStuck) {
    std::binary_semaphore entered(0);
    std::binary_semaphore leave(0);
    fakes::Source source;
    fakes::Matcher matcher([&](int stage, const FrameView&) {
        if (stage == 1) {
            entered.release();
            leave.acquire();
        }
    });
    Chain chain({.policy = Policy::replay, .slots = 2}, source, matcher, 1);
    chain.pipeline.start();
    source.push(0);
    entered.acquire();
    const auto deadline = std::chrono::steady_clock::now() + forever;
    // On a busy machine another stage may seem to be stuck for a moment.
    std::string stuck;
    while (stuck != "match" && std::chrono::steady_clock::now() < deadline) {
        std::this_thread::yield();
        stuck = chain.pipeline.stuck_stage(1500ms);
    }
    EXPECT_EQ(stuck, "match");
    leave.release();
    source.end();
    ASSERT_TRUE(chain.pipeline.wait_until_ended(forever));
    EXPECT_EQ(chain.pipeline.stuck_stage(0ms), "");
}

TEST(Pipeline, RawTapSeesEveryFrame) {
    fakes::Source source(20);
    fakes::Matcher matcher;
    std::vector<std::uint64_t> tapped;
    Chain chain({.policy = Policy::replay, .slots = 2}, source, matcher, 1,
                [&](const capture::RawFrame& frame) { tapped.push_back(frame.sequence); });
    chain.pipeline.start();
    ASSERT_TRUE(chain.pipeline.wait_until_ended(forever));
    EXPECT_EQ(tapped.size(), 20U);
}

TEST(Pipeline, RefusesTooFewSlots) {
    fakes::Source source;
    fakes::Matcher matcher;
    WorkerPool workers(1);
    const calibration::Rectification rectification = fakes::rectification();
    EXPECT_THROW(Pipeline({.slots = 1}, source, matcher, workers, rectification, [](const FrameSlot&) {}),
                 std::invalid_argument);
}

}  // namespace
}  // namespace disparityd::pipeline
