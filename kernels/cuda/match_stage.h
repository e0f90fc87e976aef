// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <optional>
#include <span>

#include "kernels/cuda/graph.h"
#include "kernels/cuda/memory.h"
#include "kernels/cuda/steps.h"
#include "kernels/cuda/stream.h"
#include "kernels/cuda/stream_clock.h"
#include "kernels/matcher.h"

namespace disparityd::cuda {

/// All that comes after rectification, on the device: rectified pair in, disparity, confidence and depth out. All
/// memory is taken when it is made.
class MatchStage {
public:
    /// Throws std::runtime_error when the device has too little memory.
    explicit MatchStage(const MatcherConfig& config);

    /// Returns the steps of a method and which of them chooses the disparities.
    static StageInfo info(Method method);

    void run(const FrameView& frame, Parallel& workers, std::span<std::chrono::nanoseconds> step_times);

private:
    /// What of a frame its operations depend on, beside the pixels.
    struct Output {
        bool depth;
        std::int64_t depth_k;
        int offset16;
        bool depth_error;
        int subpixel_error;
        int noise_level;
        bool operator==(const Output&) const = default;
    };

    void allocate_sgm();
    void start(const Output& output);
    void enqueue(const Output& output);
    void upload();
    void find_census(int noise_level);
    void find_winners(int noise_level);
    void post_process(const Output& output);
    void fill_and_finish(const Output& output);
    void start_downloads(const Output& output);
    void download(const FrameView& frame, Parallel& workers) const;
    void mark();

    View<const std::uint8_t> image(std::size_t eye) const;
    std::uint64_t* words(std::size_t eye) const;
    Range range() const { return {config_.options.range.first, config_.options.range.count}; }
    View<const std::uint8_t> smoothed(std::size_t eye) const;
    PathsJob paths_job(int noise_level) const;
    WinnerJob winner_job(int noise_level) const;

    MatcherConfig config_;
    std::size_t pixels_;
    StreamClock clock_;
    std::size_t marks_ = 0;

    std::array<PinnedBuffer, 2> pair_;
    std::array<DeviceMemory, 2> images_;    // where the pair is mapped: a copy that the device caches
    std::array<DeviceMemory, 2> smoothed_;  // where there are noise levels
    std::array<DeviceMemory, 2> words_;
    DeviceMemory left_volume_;
    std::array<DeviceMemory, 2> sweep_volume_;
    DeviceMemory edges_;
    DeviceMemory progress_;
    DeviceMemory winner_disparity_;
    DeviceMemory winner_confidence_;
    DeviceMemory left_winner_;
    DeviceMemory right_winner_;
    DeviceMemory filtered_;
    DeviceMemory before_vote_;  // where there are noise levels
    DeviceMemory measured_;
    DeviceMemory filled_;
    DeviceMemory labels_;
    DeviceMemory sizes_;
    DeviceMemory votes_;
    PinnedBuffer disparity_;
    PinnedBuffer confidence_;
    PinnedBuffer depth_;
    PinnedBuffer depth_error_;
    std::optional<Output> graph_output_;  // what the graph is for
    Graph graph_;
    Stream stream_;  // the last one, so that what runs on it ends before the memory goes
};

}  // namespace disparityd::cuda
