// SPDX-License-Identifier: Apache-2.0
//
// From capture to shared memory nothing is allocated per frame.
#include <array>
#include <atomic>
#include <memory>
#include <ostream>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "calibration/rectification.h"
#include "capture/frame_source.h"
#include "kernels/matcher.h"
#include "obstacles/scan_stage.h"
#include "pipeline/pipeline.h"
#include "pipeline/temporal_stage.h"
#include "proto/shared_memory_writer.h"
#include "tests/kernels/counted_memory.h"
#include "trust/trust_stage.h"

namespace disparityd::pipeline {
namespace {

namespace counted_memory = test::counted_memory;

TEST(Allocation, TheCounterCounts) {
    counted_memory::reset();
    auto* volatile number = new int(7);
    const std::size_t calls = counted_memory::calls();
    delete number;
    EXPECT_GE(calls, 1U);
}

// The chain of the daemon without its sockets: scene, rectification, matching, shared memory.
class Chain {
public:
    explicit Chain(const MatchOptions& match) {
        capture::SourceOptions options;
        options.uri = "scene:vga@200?width=160&height=96&loop=4";
        options.loans = slots + 2;
        source_ = capture::open_source(options);
        const capture::SourceInfo& info = source_->info();
        rectification_ = calibration::make_rectification(info.calibration, info.eye_width, info.height, {});
        matcher_ = backend("cpu").create({rectification_.width, rectification_.height, match});
        const auto width = static_cast<std::uint32_t>(rectification_.width);
        const auto height = static_cast<std::uint32_t>(rectification_.height);
        memory_ = std::make_unique<proto::SharedMemoryWriter>(
            "allocation-test-" + std::to_string(getpid()),
            proto::ShmLayout{width, height, {{1, 2}, {2, 1}, {3, 2}, {4, 1}, {5, 3}, {7, 2}}});
        scan_ =
            std::make_unique<ScanStage>(rectification_.width, rectification_.height, DisparityRange{}, ScanOptions{});
        temporal_ = std::make_unique<pipeline::TemporalStage>(rectification_.width, rectification_.height);
        trust_ =
            std::make_unique<trust::TrustStage>(rectification_.width, rectification_.height, trust::TrustOptions{});
        pipeline_ = std::make_unique<Pipeline>(PipelineConfig{.policy = Policy::live,
                                                              .slots = slots,
                                                              .depth = true,
                                                              .left_colour = true,
                                                              .right_colour = true,
                                                              .depth_error = 64,
                                                              .stages = {temporal_.get(), scan_.get(), trust_.get()}},
                                               *source_, *matcher_, workers_, rectification_,
                                               [this](const FrameSlot& slot) { publish(slot); });
        pipeline_->start();
    }

    /// Without asking for a status, which has names in it and allocates.
    void wait_for(std::uint64_t frames) const {
        for (std::uint64_t now = published_.load(); now < frames; now = published_.load()) {
            published_.wait(now);
        }
    }

    std::uint64_t published() const { return published_.load(); }
    Tracer& tracer() { return workers_.tracer(); }

private:
    static constexpr int slots = 4;

    template <typename T>
    static proto::PlaneSource source_of(std::uint32_t product, Plane<T> plane) {
        return {product, plane.data, static_cast<std::size_t>(plane.width) * sizeof(T),
                static_cast<std::size_t>(plane.stride) * sizeof(T)};
    }

    void publish(const FrameSlot& slot) {
        proto::FrameInfo frame{};
        frame.sequence = slot.raw.sequence;
        frame.width = static_cast<std::uint32_t>(rectification_.width);
        frame.height = static_cast<std::uint32_t>(rectification_.height);
        const FrameView& view = slot.view;
        const std::array<proto::PlaneSource, 6> planes{source_of(1, view.disparity),   source_of(2, view.confidence),
                                                       source_of(3, view.depth),       source_of(4, view.left),
                                                       source_of(5, view.left_colour), source_of(7, view.depth_error)};
        memory_->publish(frame, planes);
        memory_->wake();
        memory_->heartbeat();
        published_.fetch_add(1);
        published_.notify_one();
    }

    std::unique_ptr<capture::FrameSource> source_;
    calibration::Rectification rectification_;
    std::unique_ptr<Matcher> matcher_;
    std::unique_ptr<proto::SharedMemoryWriter> memory_;
    WorkerPool workers_{2};
    std::unique_ptr<ScanStage> scan_;
    std::unique_ptr<pipeline::TemporalStage> temporal_;
    std::unique_ptr<trust::TrustStage> trust_;
    std::atomic<std::uint64_t> published_{0};
    std::unique_ptr<Pipeline> pipeline_;  // last: its threads use the rest
};

/// Each of the matchers that the back end chooses from.
struct Case {
    const char* name;
    Method method;
    int paths = 8;
    int p2 = 63;

    MatchOptions options() const {
        MatchOptions options = default_options(method, {0, 32});
        options.sgm.paths = paths;
        options.sgm.p2 = p2;
        options.post.speckle_size = 40;
        options.post.interpolate = true;
        return options;
    }
};

// What a failure shows; found by GoogleTest.
void PrintTo(const Case& matcher, std::ostream* out) {
    *out << matcher.name;
}

class NoAllocation : public testing::TestWithParam<Case> {};

TEST_P(NoAllocation, FromCaptureToSharedMemory) {
    const Chain chain(GetParam().options());
    chain.wait_for(20);  // queues and thread-local places of the libraries are made with the first frames
    const std::uint64_t before = chain.published();
    counted_memory::reset();
    chain.wait_for(before + 60);
    EXPECT_EQ(counted_memory::calls(), 0U);
}

TEST_P(NoAllocation, WhileATraceIsTaken) {
    Chain chain(GetParam().options());
    chain.wait_for(20);
    chain.tracer().begin();
    chain.wait_for(chain.published() + 2);  // every thread has written an event
    const std::uint64_t before = chain.published();
    counted_memory::reset();
    chain.wait_for(before + 40);
    EXPECT_EQ(counted_memory::calls(), 0U);
    EXPECT_FALSE(chain.tracer().end().tracks.empty());
}

INSTANTIATE_TEST_SUITE_P(Methods, NoAllocation,
                         testing::Values(Case{"sad", Method::sad}, Case{"census", Method::census},
                                         Case{"sgm", Method::sgm}, Case{"sgm_four_paths", Method::sgm, 4},
                                         Case{"sgm_large_p2", Method::sgm, 8, 120}),
                         [](const auto& matcher) { return std::string(matcher.param.name); });

}  // namespace
}  // namespace disparityd::pipeline
