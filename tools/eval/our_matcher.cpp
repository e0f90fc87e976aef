// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/our_matcher.h"

#include <algorithm>
#include <chrono>

#include <opencv2/imgproc.hpp>

#include "pipeline/aligned_buffer.h"

namespace disparityd::eval {
namespace {

using std::chrono::steady_clock;

/// The pair as a camera would send it.
RawImage side_by_side(const cv::Mat& left, const cv::Mat& right, cv::Mat& storage) {
    cv::hconcat(left, right, storage);
    const PixelFormat format = storage.channels() == 3 ? PixelFormat::bgr24 : PixelFormat::grey8;
    return {storage.data, format, left.cols, left.rows, static_cast<std::ptrdiff_t>(storage.step[0])};
}

std::size_t most_steps(const Matcher& matcher) {
    std::size_t most = 0;
    for (const StageInfo& stage : matcher.stages()) {
        most = std::max(most, stage.steps.size());
    }
    return most;
}

}  // namespace

double median(std::vector<double> times) {
    std::sort(times.begin(), times.end());
    const std::size_t middle = times.size() / 2;
    return times.size() % 2 == 1 ? times[middle] : (times[middle - 1] + times[middle]) / 2;
}

MatcherResult run_ours(const Backend& backend, const MatchOptions& options, const cv::Mat& left, const cv::Mat& right,
                       Parallel& workers, int repeat) {
    const int width = left.cols;
    const int height = left.rows;
    const std::size_t pixels = left.total();
    const auto matcher = backend.create({width, height, options});

    using pipeline::AlignedBuffer;
    const AlignedBuffer left_plane(pixels), right_plane(pixels), disparity(2 * pixels), confidence(pixels);
    const AlignedBuffer scratch(matcher->scratch_bytes());
    const Rectifier as_it_is;
    cv::Mat storage;
    FrameView frame;
    frame.raw = side_by_side(left, right, storage);
    frame.rectifier = &as_it_is;
    frame.left = left_plane.plane<std::uint8_t>(width, height);
    frame.right = right_plane.plane<std::uint8_t>(width, height);
    frame.disparity = disparity.plane<std::int16_t>(width, height);
    frame.confidence = confidence.plane<std::uint8_t>(width, height);
    frame.scratch = {scratch.data(), scratch.size()};

    // The first stage makes the grey pair, as it does in the pipeline; it is no part of the time.
    std::vector<std::chrono::nanoseconds> step_times(most_steps(*matcher));
    matcher->run(0, frame, workers, std::span(step_times).first(matcher->stages()[0].steps.size()));
    std::vector<double> times;
    for (int i = 0; i < repeat; ++i) {
        const auto start = steady_clock::now();
        match(*matcher, frame, workers);
        times.push_back(std::chrono::duration<double, std::milli>(steady_clock::now() - start).count());
    }
    return {width, height, options.range, {frame.disparity.data, frame.disparity.data + pixels}, median(times)};
}

}  // namespace disparityd::eval
