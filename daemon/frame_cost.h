// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>
#include <string>

namespace disparityd::daemon {

/// What a frame costs on this computer, measured with a few.
struct FrameCost {
    using Seconds = std::chrono::duration<double>;

    /// Frames of the source were taken. False: noise was, as the frames of a camera cannot be had for this.
    bool of_source = false;
    Seconds passes{};  ///< the least time that one took alone, from its rectification to its publication
    Seconds used{};    ///< processor time of the whole process for one, from rectification to publication; the median
    /// Processor time of the source for each frame that comes; nothing: not known.
    std::optional<Seconds> taken = {};
    std::string unread = {};  ///< one line: why none could be read; empty where that went well, or was not tried
};

/// What is asked of the computer.
struct FrameLoad {
    double rate = 0;         ///< frames that come in a second; 0: not known
    bool leaves_out = true;  ///< frames that are too many are left out; false: they wait
    double budget = 0;       ///< [pipeline] cores; 0: none
    int width = 0;           ///< of rectified images, px
    int height = 0;
    int disparities = 0;
};

/// Returns how many frames in a second the budget allows at most, clients and recordings left aside; `load` has one.
/// Those that are left out cost their capture, too.
double most_in_budget(const FrameCost& cost, const FrameLoad& load);

/// Returns a line for people: why none could be read where that is so, the time that a frame takes, what of it counts
/// against the budget, and where frames come faster than they can be worked on, what would fit.
std::string cost_text(const FrameCost& cost, const FrameLoad& load);

}  // namespace disparityd::daemon
