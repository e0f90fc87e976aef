// SPDX-License-Identifier: Apache-2.0
//
// What a frame costs, before any is served: --check tells it.
#include <algorithm>
#include <random>
#include <stdexcept>
#include <utility>

#include "base/failure_text.h"
#include "daemon/configured_source.h"
#include "daemon/engine.h"
#include "daemon/frame_cost.h"
#include "daemon/repeated_frame.h"

namespace disparityd::daemon {
namespace {

using std::chrono::steady_clock;
using Seconds = FrameCost::Seconds;

constexpr int slots = 2;           // as few as a pipeline may have
constexpr int frames = slots + 5;  // the first of each slot has memory to fill

/// Grey levels that nothing can be matched in, for both eyes.
std::vector<std::uint8_t> noise_for(const capture::SourceInfo& info) {
    std::vector<std::uint8_t> pixels(row_bytes(info) * static_cast<std::size_t>(info.height));
    std::minstd_rand random;
    std::generate(pixels.begin(), pixels.end(), [&] { return static_cast<std::uint8_t>(random() >> 8); });
    return pixels;
}

std::vector<std::uint8_t> pixels_of(const capture::RawFrame& frame, const capture::SourceInfo& info) {
    std::vector<std::uint8_t> pixels;
    for (int y = 0; y < frame.image.height; ++y) {
        const std::uint8_t* row = frame.image.data + y * frame.image.stride;
        pixels.insert(pixels.end(), row, row + row_bytes(info));
    }
    return pixels;
}

/// A picture of a source, and the processor time for each of some that it gave.
struct Taken {
    std::vector<std::uint8_t> pixels;  ///< empty: none came
    std::optional<Seconds> cost;
    std::string problem;  ///< why none came
};

/// Takes a few frames. What is damaged behind the first one is told when it is played.
Taken take_some(capture::FrameSource& source) {
    constexpr std::chrono::seconds patience{5};
    Taken taken;
    std::chrono::nanoseconds begin{};
    bool any = false;
    // Not measured: the first, at which much is made ready, and those that a recording may have decoded before.
    constexpr int unmeasured = 9, most = 4;
    int count = -unmeasured;
    try {
        capture::RawFrame frame;
        const auto deadline = steady_clock::now() + patience;
        while (count < most && source.next(frame, deadline) == capture::FrameSource::Next::frame) {
            if (taken.pixels.empty() && (frame.flags & capture::frame_flag_corrupt) == 0) {
                taken.pixels = pixels_of(frame, source.info());
            }
            source.give_back(frame);
            begin = count < 0 ? pipeline::processor_time() : begin;
            any = true;
            ++count;
        }
    } catch (const std::runtime_error& error) {
        taken.problem = any ? "" : base::failure_text(error);
        return taken;
    }
    if (count > 0) {
        taken.cost = Seconds(pipeline::processor_time() - begin) / count;
    }
    return taken;
}

/// A place that frames are copied to, as they are to the shared memory.
class Copy {
public:
    void take(const PublishedFrame& frame, std::size_t planes) {
        std::size_t at = 0;
        for (std::size_t i = 0; i < planes; ++i) {
            const auto& plane = frame.planes[i];
            const std::size_t width = static_cast<std::size_t>(plane.width);
            bytes_.resize(std::max(bytes_.size(), at + width * static_cast<std::size_t>(plane.height)));
            for (int y = 0; y < plane.height; ++y, at += width) {
                std::copy_n(plane.data + y * plane.stride, width, bytes_.begin() + static_cast<std::ptrdiff_t>(at));
            }
        }
    }

private:
    std::vector<std::uint8_t> bytes_;
};

Seconds median_of(std::vector<Seconds> times) {
    const auto middle = times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2);
    std::nth_element(times.begin(), middle, times.end());
    return *middle;
}

/// Returns how long no frame begins after one that took so much, as far as is worth waiting for.
std::chrono::nanoseconds pause_after(Seconds used, const FrameLoad& load) {
    constexpr Seconds most{0.25};
    Seconds apart{};  // of a replay, frames follow each other
    if (load.leaves_out && load.rate > 0) {
        apart = Seconds(1 / load.rate);
    }
    if (load.budget > 0) {
        apart = std::max(apart, used / load.budget);
    }
    return std::chrono::duration_cast<std::chrono::nanoseconds>(std::clamp(apart - used, Seconds(0), most));
}

/// Returns the time that the steps of a frame took, less what they waited for.
Seconds worked(const pipeline::FrameSlot& slot, const std::vector<std::string>& names) {
    Seconds sum{};
    for (std::size_t i = 0; i < names.size(); ++i) {
        sum += names[i].starts_with("wait") ? Seconds(0) : Seconds(slot.step_times[i]);
    }
    return sum;
}

}  // namespace

FrameCost Engine::cost_of_frame() {
    FrameCost cost{.passes = Seconds::max()};
    wanted_ = [] { return true; };
    // A camera is not opened for a check: another daemon may have it.
    const bool is_camera = source().live && !source().synthetic;
    Taken taken = is_camera ? Taken() : take_some(*source_);
    cost.of_source = !taken.pixels.empty();
    cost.taken = taken.cost;
    cost.unread = std::move(taken.problem);
    RepeatedFrame repeated(source(), cost.of_source ? std::move(taken.pixels) : noise_for(source()), frames);

    make_measured();
    Copy copy;
    sink_ = [&](const PublishedFrame& frame) { copy.take(frame, layout_.products.size()); };
    pipeline::PipelineConfig made = pipeline_config();
    made.policy = pipeline::Policy::replay;
    made.slots = slots;
    const FrameLoad asked = load();
    std::vector<Seconds> used;
    std::chrono::nanoseconds before = pipeline::processor_time();
    std::optional<pipeline::Pipeline> trial;
    trial.emplace(made, repeated, *matcher_, workers_, rectifications_->factory(),
                  [&](const pipeline::FrameSlot& slot) {
                      publish(slot);
                      const std::chrono::nanoseconds now = pipeline::processor_time();
                      used.emplace_back(now - std::exchange(before, now));
                      cost.passes = std::min(cost.passes, worked(slot, trial->steps()));
                      repeated.let_go(pause_after(used.back(), asked));
                  });
    trial->start();
    while (!trial->wait_until_ended(std::chrono::seconds(1))) {
    }
    if (const std::string error = trial->status().error; !error.empty()) {
        throw std::runtime_error(error);
    }
    used.erase(used.begin(), used.begin() + slots);
    cost.used = median_of(std::move(used));
    return cost;
}

FrameLoad Engine::load() const {
    return {.rate = source().rate,
            .leaves_out = newest_wins(config_, source().live),
            .budget = config_.pipeline.cores.value_or(0),
            .width = static_cast<int>(layout_.geometry.width),
            .height = static_cast<int>(layout_.geometry.height),
            .disparities = config_.match.options.range.count};
}

std::string Engine::work() {
    return cost_text(cost_of_frame(), load());
}

}  // namespace disparityd::daemon
