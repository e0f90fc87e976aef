// SPDX-License-Identifier: Apache-2.0
#include "kernels/cuda/match_stage.h"

#include "kernels/cuda/device.h"
#include "kernels/cuda/host_planes.h"
#include "kernels/noise/noise_level.h"

namespace disparityd::cuda {

namespace {

using std::chrono::nanoseconds;
using std::chrono::steady_clock;

constexpr std::array<std::string_view, 7> sad_steps = {
    "upload", "sad+wta", "left-right+median", "speckle", "interpolate+depth", "guided-median", "download"};
constexpr std::array<std::string_view, 8> census_steps = {
    "upload", "census", "dsi+wta", "left-right+median", "speckle", "interpolate+depth", "guided-median", "download"};
constexpr std::array<std::string_view, 10> sgm_steps = {"upload",
                                                        "census",
                                                        "dsi+sweeps",
                                                        "dsi+path",
                                                        "dsi+aggregate+wta",
                                                        "left-right+median",
                                                        "speckle",
                                                        "interpolate+depth",
                                                        "guided-median",
                                                        "download"};

static_assert(sad_steps[1] == "sad+wta" && census_steps[2] == "dsi+wta" && sgm_steps[4] == "dsi+aggregate+wta",
              "the winner steps of info()");

Cost cost_of(const MatchOptions& options) {
    return options.cost == CensusCost::census_9x7 ? Cost::census_9x7 : Cost::census_7x5_gradient;
}

}  // namespace

StageInfo MatchStage::info(Method method) {
    switch (method) {
        case Method::sad: return {StageKind::match, sad_steps, 1};
        case Method::census: return {StageKind::match, census_steps, 2};
        case Method::sgm: break;
    }
    return {StageKind::match, sgm_steps, 4};
}

MatchStage::MatchStage(const MatcherConfig& config)
    : config_(config),
      pixels_(static_cast<std::size_t>(config.width) * static_cast<std::size_t>(config.height)),
      clock_(info(config.options.method).steps.size() + 1) {
    const MatchOptions& options = config.options;
    for (std::size_t eye = 0; eye < 2; ++eye) {
        pair_[eye] = PinnedBuffer(pixels_, "the rectified pair");
        if (device_is_integrated()) {
            images_[eye] = DeviceMemory(pixels_, "the rectified pair");
        }
        if (has_noise_levels(options)) {
            smoothed_[eye] = DeviceMemory(pixels_, "the smoothed pair");
        }
        if (options.method != Method::sad) {
            const std::size_t words = margin_words + pixels_ + 2 * margin_words;
            const std::size_t bytes =
                words * static_cast<std::size_t>(word_size(cost_of(options))) * sizeof(std::uint64_t);
            words_[eye] = DeviceMemory(bytes, "the census words");
            // What stands in the margins is read and does not matter; that nobody wrote it would be found by checkers.
            check(cudaMemsetAsync(words_[eye].as<void>(), 0, bytes, stream_.get()), "clearing the census words");
        }
    }
    stream_.wait("clearing the census words");
    if (options.method == Method::sgm) {
        allocate_sgm();
    }
    winner_disparity_ = DeviceMemory(pixels_ * sizeof(std::int16_t), "the winners");
    winner_confidence_ = DeviceMemory(pixels_, "the winners");
    left_winner_ = DeviceMemory(pixels_ * sizeof(std::int16_t), "the winners");
    right_winner_ = DeviceMemory(pixels_ * sizeof(std::int16_t), "the winners");
    filtered_ = DeviceMemory(pixels_ * sizeof(std::int16_t), "the filtered disparities");
    if (has_noise_levels(options)) {
        before_vote_ = DeviceMemory(pixels_ * sizeof(std::int16_t), "the filtered disparities");
    }
    if (options.post.interpolate) {
        measured_ = DeviceMemory(sizeof(std::uint32_t), "the count of measured pixels");
    }
    if (options.post.guided_median > 0) {
        filled_ = DeviceMemory(pixels_ * sizeof(std::int16_t), "the filled disparities");
    }
    if (filters_regions(options.post)) {
        labels_ = DeviceMemory(pixels_ * sizeof(std::uint32_t), "the speckle filter");
        sizes_ = DeviceMemory(pixels_ * sizeof(std::uint32_t), "the speckle filter");
    }
    if (options.post.min_texture > 0) {
        votes_ = DeviceMemory(pixels_ * sizeof(int), "the speckle filter");
    }
    disparity_ = PinnedBuffer(pixels_ * sizeof(std::int16_t), "the disparities");
    confidence_ = PinnedBuffer(pixels_, "the confidences");
    depth_ = PinnedBuffer(pixels_ * sizeof(std::uint16_t), "the depths");
    depth_error_ = PinnedBuffer(pixels_ * sizeof(std::uint16_t), "the depth errors");
}

void MatchStage::allocate_sgm() {
    const SgmOptions& sgm = config_.options.sgm;
    const SgmBytes bytes = sgm_bytes(config_.width, config_.height, config_.options.range.count, sgm.paths, sgm.p2);
    left_volume_ = DeviceMemory(bytes.left_volume, "the path costs");
    for (DeviceMemory& volume : sweep_volume_) {
        volume = DeviceMemory(bytes.sweep_volume, "the path costs");
    }
    if (bytes.edges > 0) {
        edges_ = DeviceMemory(bytes.edges, "the path costs");
        progress_ = DeviceMemory(bytes.progress, "the path costs");
    }
}

void MatchStage::run(const FrameView& frame, Parallel& workers, std::span<nanoseconds> step_times) {
    const auto begin = steady_clock::now();
    gather<std::uint8_t>(frame.left, pair_[0].host<std::uint8_t>(), workers);
    gather<std::uint8_t>(frame.right, pair_[1].host<std::uint8_t>(), workers);
    const auto gathered = steady_clock::now();
    start({static_cast<bool>(frame.depth), frame.depth_scale.k, frame.depth_scale.offset16,
           static_cast<bool>(frame.depth_error), frame.subpixel_error, noise_level_of(config_.options, frame)});
    stream_.wait("matching");
    const auto matched = steady_clock::now();
    download(frame, workers);
    for (std::size_t i = 0; i < step_times.size(); ++i) {
        step_times[i] = clock_.after(i);
    }
    step_times.front() += gathered - begin;
    step_times.back() += steady_clock::now() - matched;
}

void MatchStage::start(const Output& output) {
    if (graph_output_ != output) {
        graph_output_.reset();
        graph_.capture(stream_, [&] { enqueue(output); });
        graph_output_ = output;
    }
    if (graph_.holds_operations()) {
        graph_.start(stream_);
    } else {
        enqueue(output);
    }
}

void MatchStage::enqueue(const Output& output) {
    marks_ = 0;
    upload();
    find_winners(output.noise_level);
    post_process(output);
}

void MatchStage::mark() {
    clock_.mark(marks_++, stream_);
}

View<const std::uint8_t> MatchStage::image(std::size_t eye) const {
    const auto* copy = images_[eye].as<const std::uint8_t>();
    return {copy != nullptr ? copy : pair_[eye].device<const std::uint8_t>(), config_.width, config_.height,
            config_.width};
}

View<const std::uint8_t> MatchStage::smoothed(std::size_t eye) const {
    return {smoothed_[eye].as<const std::uint8_t>(), config_.width, config_.height, config_.width};
}

std::uint64_t* MatchStage::words(std::size_t eye) const {
    return words_[eye].as<std::uint64_t>() + margin_words * word_size(cost_of(config_.options));
}

void MatchStage::upload() {
    mark();
    for (std::size_t eye = 0; eye < 2; ++eye) {
        pair_[eye].to_device(stream_);
        if (images_[eye].as<void>() != nullptr) {
            check(cudaMemcpyAsync(images_[eye].as<void>(), pair_[eye].device<const void>(), pixels_, cudaMemcpyDefault,
                                  stream_.get()),
                  "copying the rectified pair");
        }
    }
    mark();
}

PathsJob MatchStage::paths_job(int noise_level) const {
    const SgmOptions sgm = at_noise_level(config_.options, noise_level).sgm;
    return {{words(0), words(1)},
            noise_level > 0 ? smoothed(0) : image(0),
            range(),
            sgm.p1,
            sgm.p2,
            sgm.adaptive_p2,
            sgm.p2_slope,
            sgm.p2_min,
            sgm.paths,
            is_wide(sgm.paths, sgm.p2),
            cost_of(config_.options),
            left_volume_.as<std::uint8_t>(),
            {sweep_volume_[0].as<std::uint8_t>(), sweep_volume_[1].as<std::uint8_t>()},
            edges_.as<std::uint8_t>(),
            progress_.as<int>()};
}

WinnerJob MatchStage::winner_job(int noise_level) const {
    const PostOptions post = at_noise_level(config_.options, noise_level).post;
    return {config_.width,
            config_.height,
            range(),
            post.subpixel,
            post.local_extrema,
            post.uniqueness,
            winner_disparity_.as<std::int16_t>(),
            winner_confidence_.as<std::uint8_t>(),
            left_winner_.as<std::int16_t>(),
            right_winner_.as<std::int16_t>()};
}

void MatchStage::find_census(int noise_level) {
    if (noise_level == 0) {
        census(cost_of(config_.options), image(0), image(1), words(0), words(1), stream_.get());
        return;
    }
    smooth(image(0), image(1), smoothed_[0].as<std::uint8_t>(), smoothed_[1].as<std::uint8_t>(), stream_.get());
    noisy_census(census_coarseness(noise_level), {image(0), smoothed(0)}, {image(1), smoothed(1)}, words(0), words(1),
                 stream_.get());
}

void MatchStage::find_winners(int noise_level) {
    const Method method = config_.options.method;
    if (method == Method::sad) {
        sad_winners(image(0), image(1), winner_job(noise_level), stream_.get());
        mark();
        return;
    }
    find_census(noise_level);
    mark();
    const PathsJob paths = paths_job(noise_level);
    if (method == Method::census) {
        census_winners(paths.cost, paths.words, winner_job(noise_level), stream_.get());
    } else {
        sweep(paths, stream_.get());
        mark();
        path_to_left(paths, stream_.get());
        mark();
        sgm_winners(paths, winner_job(noise_level), stream_.get());
    }
    mark();
}

void MatchStage::post_process(const Output& output) {
    const PostOptions& post = config_.options.post;
    const bool votes = output.noise_level > 0;
    left_right_median(
        {config_.width, config_.height, range(), winner_disparity_.as<const std::int16_t>(),
         left_winner_.as<const std::int16_t>(), right_winner_.as<const std::int16_t>(), post.left_right_check,
         post.median, votes ? before_vote_.as<std::int16_t>() : filtered_.as<std::int16_t>()},
        stream_.get());
    if (votes) {
        vote({config_.width, config_.height, invalid_disparity(config_.options.range),
              before_vote_.as<const std::int16_t>(), filtered_.as<std::int16_t>()},
             stream_.get());
    }
    mark();
    if (filters_regions(post)) {
        speckle({config_.width, config_.height, invalid_disparity(config_.options.range), post.speckle_size,
                 16 * post.speckle_step, filtered_.as<std::int16_t>(), labels_.as<std::uint32_t>(),
                 sizes_.as<std::uint32_t>(), post.min_texture, image(0), image(1), votes_.as<int>()},
                stream_.get());
    }
    mark();
    fill_and_finish(output);
    start_downloads(output);
}

// Steps 11 to 13.
void MatchStage::fill_and_finish(const Output& output) {
    const PostOptions& post = config_.options.post;
    const bool guided = post.guided_median > 0;
    const DepthJob scale{output.depth_k, output.offset16};
    if (post.interpolate) {
        count_measured({config_.width, config_.height, invalid_disparity(config_.options.range),
                        filtered_.as<const std::int16_t>(), measured_.as<std::uint32_t>()},
                       stream_.get());
    }
    auto* const depth = output.depth ? depth_.device<std::uint16_t>() : nullptr;
    interpolate_depth(
        {config_.width, config_.height, range(), post.interpolate ? measured_.as<const std::uint32_t>() : nullptr,
         filtered_.as<const std::int16_t>(), right_winner_.as<const std::int16_t>(),
         winner_confidence_.as<const std::uint8_t>(), scale, ConfidenceJob(calibrates_confidence(config_.options)),
         guided ? filled_.as<std::int16_t>() : disparity_.device<std::int16_t>(), confidence_.device<std::uint8_t>(),
         guided ? nullptr : depth},
        stream_.get());
    mark();
    if (guided) {
        guided_median({config_.width, config_.height, range(), post.guided_median, filled_.as<const std::int16_t>(),
                       image(0), scale, disparity_.device<std::int16_t>(), depth},
                      stream_.get());
    }
    if (output.depth_error) {
        depth_error({config_.width, config_.height, disparity_.device<const std::int16_t>(),
                     confidence_.device<const std::uint8_t>(),
                     depth_error_scale(output.depth_k, output.offset16, output.subpixel_error),
                     depth_error_.device<std::uint16_t>()},
                    stream_.get());
    }
    mark();
}

void MatchStage::start_downloads(const Output& output) {
    disparity_.to_host(stream_);
    confidence_.to_host(stream_);
    if (output.depth) {
        depth_.to_host(stream_);
    }
    if (output.depth_error) {
        depth_error_.to_host(stream_);
    }
    mark();
}

void MatchStage::download(const FrameView& frame, Parallel& workers) const {
    scatter(disparity_.host<const std::int16_t>(), frame.disparity, workers);
    scatter(confidence_.host<const std::uint8_t>(), frame.confidence, workers);
    if (frame.depth) {
        scatter(depth_.host<const std::uint16_t>(), frame.depth, workers);
    }
    if (frame.depth_error) {
        scatter(depth_error_.host<const std::uint16_t>(), frame.depth_error, workers);
    }
}

}  // namespace disparityd::cuda
