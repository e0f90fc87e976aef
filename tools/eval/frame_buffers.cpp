// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/frame_buffers.h"

#include <chrono>
#include <optional>
#include <span>

#include "kernels/near_plane.h"
#include "kernels/noise/match_alone.h"
#include "tools/eval/means.h"

namespace disparityd::eval {
namespace {

/// The pair as a camera would send it.
RawImage side_by_side(const cv::Mat& left, const cv::Mat& right, cv::Mat& storage) {
    cv::hconcat(left, right, storage);
    const PixelFormat format = storage.channels() == 3 ? PixelFormat::bgr24 : PixelFormat::grey8;
    return {storage.data, format, left.cols, left.rows, static_cast<std::ptrdiff_t>(storage.step[0])};
}

std::size_t steps_after_the_first_stage(const Matcher& matcher) {
    std::size_t count = 0;
    for (const StageInfo& stage : matcher.stages().subspan(1)) {
        count += stage.steps.size();
    }
    return count;
}

}  // namespace

using std::chrono::steady_clock;

MatcherResult run_ours(const Backend& backend, const MatchOptions& options, const cv::Mat& left, const cv::Mat& right,
                       Parallel& workers, int repeat) {
    const auto matcher = backend.create({left.cols, left.rows, options});
    FrameBuffers frame(*matcher, left, right, workers);
    std::optional<int> noise_level;
    if (adapts_to_noise(options)) {
        frame.match_alone(workers);
        noise_level = frame.view().noise_level;
    }
    std::vector<double> times;
    for (int i = 0; i < repeat; ++i) {
        const auto start = steady_clock::now();
        frame.match(workers);
        times.push_back(std::chrono::duration<double, std::milli>(steady_clock::now() - start).count());
    }
    const std::int16_t* d16 = frame.view().disparity.data;
    const std::uint8_t* confidence = frame.view().confidence.data;
    return {left.cols,     left.rows,
            options.range, {d16, d16 + left.total()},
            median(times), {confidence, confidence + left.total()},
            noise_level};
}

FrameBuffers::FrameBuffers(Matcher& matcher, const cv::Mat& left, const cv::Mat& right, Parallel& workers)
    : matcher_(matcher),
      left_(left.total()),
      right_(left.total()),
      disparity_(2 * left.total()),
      confidence_(left.total()),
      near_(sizeof(std::int16_t) * left.total()),
      scratch_(matcher.scratch_bytes()),
      step_times_(steps_after_the_first_stage(matcher)) {
    const int width = left.cols;
    const int height = left.rows;
    const Rectifier as_it_is;
    cv::Mat storage;
    frame_.raw = side_by_side(left, right, storage);
    frame_.rectifier = &as_it_is;
    frame_.left = left_.plane<std::uint8_t>(width, height);
    frame_.right = right_.plane<std::uint8_t>(width, height);
    frame_.disparity = disparity_.plane<std::int16_t>(width, height);
    frame_.confidence = confidence_.plane<std::uint8_t>(width, height);
    if (matcher.config().options.post.near_guard) {
        frame_.near = near_.plane<std::int16_t>(near_blocks(width), near_blocks(height));
    }
    frame_.scratch = {scratch_.data(), scratch_.size()};
    std::vector<std::chrono::nanoseconds> first_stage_times(matcher.stages()[0].steps.size());
    matcher.run(0, frame_, workers, first_stage_times);
    frame_.raw = {};
    frame_.rectifier = nullptr;
}

void FrameBuffers::match(Parallel& workers) {
    const std::span<const StageInfo> stages = matcher_.stages();
    std::span<std::chrono::nanoseconds> times(step_times_);
    for (std::size_t i = 1; i < stages.size(); ++i) {
        matcher_.run(static_cast<int>(i), frame_, workers, times.first(stages[i].steps.size()));
        times = times.subspan(stages[i].steps.size());
    }
}

void FrameBuffers::match_alone(Parallel& workers) {
    disparityd::match_alone(matcher_.config().options, frame_, [&] { match(workers); });
}

void FrameBuffers::match_at(int noise_level, Parallel& workers) {
    frame_.noise_level = noise_level;
    match(workers);
}

}  // namespace disparityd::eval
