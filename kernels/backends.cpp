// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <stdexcept>
#include <string>

#include "kernels/cpu/backend.h"
#include "kernels/cpu/step_kernels.h"
#ifdef DISPARITYD_WITH_CUDA
#include "kernels/cuda/backend.h"
#endif
#include "kernels/fallback_matcher.h"
#include "kernels/frame_stages.h"
#include "kernels/matcher.h"
#include "kernels/near_guard.h"
#include "kernels/reference/steps.h"
#include "kernels/step_matcher.h"
#include "kernels/steps.h"

namespace disparityd {

namespace {

bool everywhere() {
    return true;
}

std::unique_ptr<Matcher> create_reference(const MatcherConfig& config) {
    return with_near_guard(checked(config), reference::steps.frame, [](const MatcherConfig& made) {
        return std::make_unique<StepMatcher>(made, reference::steps);
    });
}

std::string nothing_missing() {
    return {};
}

std::string no_vector_instructions() {
    return cpu::available() ? "" : "this processor has none of the vector instructions that it is built for";
}

constexpr std::string_view cuda_description = "an NVIDIA GPU";

#ifdef DISPARITYD_WITH_CUDA
constexpr Backend cuda_row = {"cuda", cuda_description, cuda::available, cuda::create, cuda::unavailable_because};
#else
bool nowhere() {
    return false;
}

std::string not_built() {
    return "this program was built without CUDA (-DDISPARITYD_CUDA=ON builds with it)";
}

std::unique_ptr<Matcher> refuse(const MatcherConfig& /*config*/) {
    throw std::runtime_error("back end cuda: " + not_built());
}

constexpr Backend cuda_row = {"cuda", cuda_description, nowhere, refuse, not_built};
#endif

// The fastest first.
constexpr std::array<Backend, 3> table = {{
    cuda_row,
    {"cpu", "vector instructions, all cores of this machine", cpu::available, cpu::create_best, no_vector_instructions},
    {"reference", "the definition: plain code, one core", everywhere, create_reference, nothing_missing},
}};

std::string available_names() {
    std::string names = "auto";
    for (const Backend& row : table) {
        if (row.available()) {
            names += ", " + std::string(row.name);
        }
    }
    return names;
}

}  // namespace

const FrameSteps& fastest_frame_steps() {
    return cpu::available() ? cpu::frame_steps(cpu::instruction_sets().front().target) : reference::steps.frame;
}

std::span<const Backend> backends() {
    return table;
}

const Backend& backend(std::string_view name) {
    std::string why;
    for (const Backend& row : table) {
        if ((name == row.name || name == "auto") && row.available()) {
            return row;
        }
        why = name == row.name ? " (" + row.unavailable_because() + ")" : why;
    }
    throw std::invalid_argument("no back end \"" + std::string(name) + "\" on this machine" + why + ": there are " +
                                available_names());
}

std::unique_ptr<Matcher> make_matcher(std::string_view name, const MatcherConfig& config) {
    const Backend& chosen = backend(name);
    const Backend& without_device = backend(cpu::available() ? "cpu" : "reference");
    if (name != "auto" || chosen.name != cuda_row.name) {
        return chosen.create(config);
    }
    try {
        return std::make_unique<FallbackMatcher>(chosen.create(config), without_device);
    } catch (const std::runtime_error& error) {
        return std::make_unique<SubstituteMatcher>(without_device, config, error.what());
    }
}

void match_pair(Matcher& matcher, const FrameView& frame, Parallel& workers) {
    std::array<std::chrono::nanoseconds, 16> times{};
    const std::span<const StageInfo> stages = matcher.stages();
    for (std::size_t i = 1; i < stages.size(); ++i) {
        matcher.run(static_cast<int>(i), frame, workers, std::span(times).first(stages[i].steps.size()));
    }
}

}  // namespace disparityd
