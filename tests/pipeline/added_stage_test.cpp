// SPDX-License-Identifier: Apache-2.0
//
// Stages that a configuration adds: one of each kind, and what the pipeline does for all of them.
#include "kernels/added_stage.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <functional>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/pipeline.h"
#include "tests/pipeline/fakes.h"

namespace disparityd::pipeline {
namespace {

using fakes::forever;
using testing::Each;
using testing::ElementsAre;
using testing::SizeIs;

/// Adds 100 to the left image, which the matcher turns into disparity.
class Brighter final : public AddedStage {
public:
    std::string_view name() const override { return "brighter"; }
    StagePlace place() const override { return StagePlace::before_matching; }
    bool depends_on_earlier_frames() const override { return false; }
    void run(const StageFrame& frame, Parallel& workers) override {
        workers.for_each(fakes::height, [&frame](int y) {
            for (int x = 0; x < fakes::width; ++x) {
                frame.view.left.at(x, y) = static_cast<std::uint8_t>(frame.view.left.at(x, y) + 100);
            }
        });
    }
};

/// Rejects disparities below a number.
class FarGuard final : public AddedStage {
public:
    explicit FarGuard(std::int16_t least) : least_(least) {}
    std::string_view name() const override { return "far-guard"; }
    StagePlace place() const override { return StagePlace::after_matching; }
    bool depends_on_earlier_frames() const override { return false; }
    void run(const StageFrame& frame, Parallel& /*workers*/) override {
        if (frame.view.disparity.at(0, 0) < least_) {
            frame.view.disparity.at(0, 0) = invalid_disparity({});
            frame.view.confidence.at(0, 0) = 0;
        }
    }

private:
    std::int16_t least_;
};

/// Records the mean of all disparities so far, as far as the source does not begin anew.
class Mean final : public AddedStage {
public:
    struct Record {
        std::uint64_t frames;
        std::uint64_t sequence;
        double mean;
    };

    std::string_view name() const override { return "mean"; }
    StagePlace place() const override { return StagePlace::record; }
    bool depends_on_earlier_frames() const override { return true; }
    std::size_t bytes_per_frame() const override { return sizeof(Record); }
    void run(const StageFrame& frame, Parallel& /*workers*/) override {
        if (frame.discontinuity) {
            sum_ = 0;
            frames_ = 0;
        }
        sum_ += frame.view.disparity.at(0, 0);
        ++frames_;
        const Record record{frames_, frame.sequence, sum_ / static_cast<double>(frames_)};
        std::memcpy(frame.memory.data(), &record, sizeof record);
    }

    static Record of(const FrameSlot& slot, std::size_t stage) {
        Record record{};
        EXPECT_EQ(slot.stage_memory.at(stage).size(), sizeof record);
        std::memcpy(&record, slot.stage_memory.at(stage).data(), sizeof record);
        return record;
    }

private:
    double sum_ = 0;
    std::uint64_t frames_ = 0;
};

/// Calls a function for each frame.
class Called final : public AddedStage {
public:
    Called(StagePlace place, std::function<void(const StageFrame&)> function, std::size_t bytes = 0)
        : place_(place), function_(std::move(function)), bytes_(bytes) {}
    std::string_view name() const override { return "called"; }
    StagePlace place() const override { return place_; }
    bool depends_on_earlier_frames() const override { return false; }
    std::size_t bytes_per_frame() const override { return bytes_; }
    void run(const StageFrame& frame, Parallel& /*workers*/) override { function_(frame); }

private:
    StagePlace place_;
    std::function<void(const StageFrame&)> function_;
    std::size_t bytes_;
};

calibration::Rectification metric_rectification() {
    calibration::Rectification rectification = fakes::rectification();
    rectification.f = 100;
    rectification.cx = 3.5;
    rectification.cy = 0.5;
    rectification.baseline_mm = 50;
    return rectification;
}

/// Runs a pipeline over a source until its end.
PipelineStatus run(
    const PipelineConfig& config, fakes::Source& source, const Pipeline::Sink& sink = [](const auto&) {},
    std::function<void(int, const FrameView&)> matcher_hook = {}) {
    fakes::Matcher matcher(std::move(matcher_hook));
    WorkerPool workers(2);
    const calibration::Rectification rectification = metric_rectification();
    Pipeline pipeline(config, source, matcher, workers, rectification, sink);
    pipeline.start();
    EXPECT_TRUE(pipeline.wait_until_ended(forever));
    pipeline.stop();
    EXPECT_EQ(source.out(), 0U);
    return pipeline.status();
}

std::vector<std::string> names_of(const PipelineStatus& status) {
    std::vector<std::string> names;
    for (const auto& step : status.steps) {
        names.push_back(step.name);
    }
    return names;
}

TEST(AddedStages, OneBeforeMatchingChangesWhatIsMatched) {
    fakes::Source source(50);
    Brighter brighter;
    std::vector<int> disparities;
    const auto status = run({.stages = {&brighter}}, source, [&disparities](const FrameSlot& slot) {
        disparities.push_back(slot.view.disparity.at(0, 0));
        EXPECT_EQ(slot.view.left.at(fakes::width - 1, fakes::height - 1), slot.raw.sequence + 100);
        EXPECT_EQ(slot.view.right.at(0, 0), 0);
    });
    ASSERT_THAT(disparities, SizeIs(50));
    for (int i = 0; i < 50; ++i) {
        EXPECT_EQ(disparities[static_cast<std::size_t>(i)], i + 100);
    }
    EXPECT_THAT(names_of(status), ElementsAre("capture", "wait-start", "rectify", "brighter", "dsi", "wta",
                                              "wait-between", "publish", "total"));
    EXPECT_EQ(status.steps[2].time.count, 50U);
}

TEST(AddedStages, DepthFollowsFromWhatOneAfterMatchingLeaves) {
    constexpr std::int16_t least = 32;
    fakes::Source source(50);
    FarGuard guard(least);
    int published = 0;
    const auto sink = [&published](const FrameSlot& slot) {
        const std::int16_t disparity = slot.view.disparity.at(0, 0);
        const bool kept = slot.raw.sequence >= least;
        EXPECT_EQ(disparity, kept ? static_cast<int>(slot.raw.sequence) : invalid_disparity({}));
        const int n = std::max<int>(disparity, 1);
        EXPECT_EQ(slot.view.depth.at(0, 0), kept ? (16 * 100 * 50 + n / 2) / n : 0);
        EXPECT_EQ(slot.view.depth_error.at(0, 0) > 0, kept);
        ++published;
    };
    const auto matcher_hook = [](int stage, const FrameView& view) {
        EXPECT_FALSE(view.depth || view.depth_error) << "it would be computed twice";
        if (stage == 1) {
            view.confidence.at(0, 0) = 255;
        }
    };
    const auto status = run({.depth_error = 64, .stages = {&guard}}, source, sink, matcher_hook);
    EXPECT_EQ(published, 50);
    EXPECT_THAT(names_of(status), ElementsAre("capture", "wait-start", "rectify", "dsi", "wta", "far-guard", "depth",
                                              "wait-between", "publish", "total"));
    EXPECT_EQ(status.steps[5].time.count, 50U);
}

// The first frame is published only when every slot has a later one.
TEST(AddedStages, ARecordDependsOnEarlierFramesWhileSeveralAreInFlight) {
    constexpr int slots = 4;
    fakes::Source source(200);
    fakes::Matcher matcher;
    WorkerPool workers(2);
    const calibration::Rectification rectification = fakes::rectification();
    Mean mean;
    std::vector<Mean::Record> records;
    Pipeline* running = nullptr;
    Pipeline pipeline({.slots = slots, .stages = {&mean}}, source, matcher, workers, rectification,
                      [&](const FrameSlot& slot) {
                          while (records.empty() && running->status().captured < slots) {
                              std::this_thread::yield();
                          }
                          records.push_back(Mean::of(slot, 0));
                      });
    running = &pipeline;
    pipeline.start();
    ASSERT_TRUE(pipeline.wait_until_ended(forever));
    ASSERT_THAT(records, SizeIs(200));
    for (std::size_t i = 0; i < records.size(); ++i) {
        EXPECT_EQ(records[i].frames, i + 1);
        EXPECT_EQ(records[i].sequence, i);
        EXPECT_EQ(records[i].mean, static_cast<double>(i) / 2);
    }
}

TEST(AddedStages, LearnThatTheSourceBeginsAnew) {
    fakes::Source source;
    for (std::uint64_t i = 0; i < 6; ++i) {
        source.push(i, 0, i == 4 ? capture::frame_flag_discontinuity : capture::frame_flag_none);
    }
    source.end();
    Mean mean;
    std::vector<double> means;
    run({.stages = {&mean}}, source, [&means](const FrameSlot& slot) { means.push_back(Mean::of(slot, 0).mean); });
    EXPECT_THAT(means, ElementsAre(0, 0.5, 1, 1.5, 4, 4.5));
}

TEST(AddedStages, RunInTheOrderOfTheirPlaces) {
    fakes::Source source(20);
    Mean mean;
    FarGuard guard(0);
    Brighter brighter;
    std::vector<double> means;
    const auto status = run({.stages = {&mean, &guard, &brighter}}, source,
                            [&means](const FrameSlot& slot) { means.push_back(Mean::of(slot, 0).mean); });
    EXPECT_THAT(names_of(status), ElementsAre("capture", "wait-start", "rectify", "brighter", "dsi", "wta", "far-guard",
                                              "depth", "mean", "wait-between", "publish", "total"));
    ASSERT_THAT(means, SizeIs(20));
    EXPECT_EQ(means.back(), 100 + 9.5);
}

TEST(AddedStages, RecordsSeeWhatIsNotServed) {
    fakes::Source source(5);
    int recorded = 0;
    Called rejecting(StagePlace::served,
                     [](const StageFrame& frame) { frame.view.disparity.at(0, 0) = invalid_disparity({}); });
    Called recording(StagePlace::record, [&recorded](const StageFrame& frame) {
        recorded += frame.view.disparity.at(0, 0) != invalid_disparity({}) ? 1 : 0;
    });
    int served = 0;
    run({.stages = {&rejecting, &recording}}, source,
        [&served](const FrameSlot& slot) { served += slot.view.disparity.at(0, 0) == invalid_disparity({}) ? 1 : 0; });
    EXPECT_EQ(recorded, 5);
    EXPECT_EQ(served, 5);
}

TEST(AddedStages, KnowTheFrameAndItsCamera) {
    fakes::Source source(3);
    std::vector<std::uint64_t> sequences;
    Called called(StagePlace::record, [&sequences](const StageFrame& frame) {
        sequences.push_back(frame.sequence);
        EXPECT_EQ(frame.f, 100);
        EXPECT_EQ(frame.cx, 3.5);
        EXPECT_EQ(frame.cy, 0.5);
        EXPECT_EQ(frame.view.depth_scale.k, 16 * 100 * 50);
        EXPECT_FALSE(frame.up);
    });
    run({.stages = {&called}}, source);
    EXPECT_THAT(sequences, ElementsAre(0, 1, 2));
}

TEST(AddedStages, HaveMemoryOfTheirOwnInEachSlot) {
    constexpr std::size_t slots = 3;
    fakes::Source source(30);
    std::map<const std::byte*, int> first;
    std::set<const std::byte*> second;
    Called large(
        StagePlace::before_matching,
        [&first](const StageFrame& frame) {
            EXPECT_EQ(frame.memory.size(), 1001U);
            EXPECT_EQ(reinterpret_cast<std::uintptr_t>(frame.memory.data()) % 64, 0U);
            EXPECT_THAT(frame.memory, Each(static_cast<std::byte>(first[frame.memory.data()]++)));
            std::fill(frame.memory.begin(), frame.memory.end(), static_cast<std::byte>(first[frame.memory.data()]));
        },
        1001);
    Called small(
        StagePlace::record,
        [&second](const StageFrame& frame) {
            EXPECT_EQ(frame.memory.size(), 1U);
            EXPECT_EQ(reinterpret_cast<std::uintptr_t>(frame.memory.data()) % 64, 0U);
            second.insert(frame.memory.data());
            frame.memory[0] = std::byte{99};
        },
        1);
    run({.slots = slots, .stages = {&large, &small}}, source);
    EXPECT_THAT(first, SizeIs(slots));
    EXPECT_THAT(second, SizeIs(slots));
    for (const auto& [memory, frames] : first) {
        EXPECT_FALSE(second.contains(memory));
    }
}

TEST(AddedStages, OneThatFailsEndsThePipeline) {
    for (const StagePlace place :
         {StagePlace::before_matching, StagePlace::after_matching, StagePlace::record, StagePlace::served}) {
        fakes::Source source(100);
        Called failing(place, [](const StageFrame& frame) {
            if (frame.sequence == 9) {
                throw std::runtime_error("no room for frame 9");
            }
        });
        const auto status = run({.slots = 3, .stages = {&failing}}, source);
        EXPECT_EQ(status.error, "no room for frame 9");
        EXPECT_LE(status.published, 9U);
        EXPECT_EQ(status.captured, status.published + status.dropped) << "none is forgotten";
    }
}

TEST(AddedStages, AreFoundInTracesByName) {
    fakes::Source source;
    fakes::Matcher matcher;
    WorkerPool workers(1);
    const calibration::Rectification rectification = fakes::rectification();
    Brighter brighter;
    Mean mean;
    Pipeline pipeline({.stages = {&brighter, &mean}}, source, matcher, workers, rectification, [](const FrameSlot&) {});
    pipeline.start();
    workers.tracer().begin();
    for (std::uint64_t i = 0; i < 5; ++i) {
        source.push(i);
    }
    source.end();
    ASSERT_TRUE(pipeline.wait_until_ended(forever));
    pipeline.stop();
    const TraceLog trace = workers.tracer().end();
    std::map<std::string, int> found;
    for (const auto& track : trace.tracks) {
        for (const TraceEvent& event : track.events) {
            if (event.kind == TraceKind::work) {
                ++found[track.name + ": " + trace.names.at(event.name)];
            }
        }
    }
    EXPECT_EQ(found["rectify: brighter"], 5);
    EXPECT_EQ(found["publish: mean"], 5);
}

}  // namespace
}  // namespace disparityd::pipeline
