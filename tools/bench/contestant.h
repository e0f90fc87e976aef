// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace disparityd::bench {

/// How long a step of a frame took.
struct StepTime {
    std::string step;
    double ms = 0;
};

/// Somebody who matches one pair over and over. One thread uses it.
class Contestant {
public:
    std::string name;      ///< "cpu/sgm", "naive/sad", "opencv/3way" ..
    std::string isa;       ///< vector instructions: "AVX2", .., "compiled" (the compiler's choice), "scalar"; or "GPU"
    int threads = 1;       ///< at most
    double memory_mb = 0;  ///< held at once from its making to the end of its first frame; NaN = not known

    Contestant() = default;
    virtual ~Contestant() = default;
    Contestant(const Contestant&) = delete;
    Contestant& operator=(const Contestant&) = delete;

    /// Before the clock starts.
    virtual void prepare() {}
    /// One frame.
    virtual void run() = 0;
    /// After the clock was stopped.
    virtual void finish() {}
    /// Of the last frame; empty where steps cannot be told apart.
    virtual std::vector<StepTime> steps() const { return {}; }
};

}  // namespace disparityd::bench
