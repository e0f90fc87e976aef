// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <stdexcept>
#include <string>

#include "kernels/cpu/backend.h"
#include "kernels/matcher.h"
#include "kernels/reference/steps.h"
#include "kernels/step_matcher.h"

namespace disparityd {

namespace {

bool everywhere() {
    return true;
}

std::unique_ptr<Matcher> create_reference(const MatcherConfig& config) {
    return std::make_unique<StepMatcher>(config, reference::steps, Spread::callers_thread);
}

// The fastest first.
constexpr std::array<Backend, 2> table = {{
    {"cpu", "vector instructions, all cores of this machine", cpu::available, cpu::create_best},
    {"reference", "the definition: plain code, one core", everywhere, create_reference},
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

std::span<const Backend> backends() {
    return table;
}

const Backend& backend(std::string_view name) {
    for (const Backend& row : table) {
        if ((name == row.name || name == "auto") && row.available()) {
            return row;
        }
    }
    throw std::invalid_argument("no back end \"" + std::string(name) + "\" on this machine: there are " +
                                available_names());
}

void match(Matcher& matcher, const FrameView& frame, Parallel& workers) {
    std::array<std::chrono::nanoseconds, 16> times{};
    const std::span<const StageInfo> stages = matcher.stages();
    for (std::size_t i = 1; i < stages.size(); ++i) {
        matcher.run(static_cast<int>(i), frame, workers, std::span(times).first(stages[i].steps.size()));
    }
}

}  // namespace disparityd
