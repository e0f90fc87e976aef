// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <string>

#include "capture/gstreamer/gst_feed.h"

namespace disparityd::capture {

struct StereoPipelineState;

/// A pipeline of GStreamer and its appsinks. What may take long, or never end, is done in a thread of GStreamer, so
/// that no call waits for an element that hangs. One thread uses an object; its feed() says who else may.
class StereoPipeline {
public:
    /// Makes the pipeline. Of each eye so many pictures may wait. Throws std::invalid_argument with one line for text
    /// that is no pipeline, and for other appsinks than one, or left and right; std::runtime_error while `most_left`
    /// pipelines of this process hang after their end: each keeps its memory and threads.
    StereoPipeline(const std::string& text, std::size_t waiting);
    ~StereoPipeline();
    StereoPipeline(const StereoPipeline&) = delete;
    StereoPipeline& operator=(const StereoPipeline&) = delete;

    /// Whether each eye has an appsink.
    bool has_two_sinks() const;

    /// The kinds of elements that take frames from devices or the network, such as "v4l2src"; empty: from files or test
    /// sources only. Elements that are made while it starts are known after ask_live().
    const std::string& devices() const;

    /// Lets it play. What comes of that is told by feed().
    void start();

    /// Asks the pipeline whether it is live, when pictures have come; feed() then knows, too. Devices that stamp what
    /// they get with do-timestamp=true are live, too.
    bool ask_live();

    GstFeed& feed();

    /// What feed().problem() says, with what to do about it. There must be one.
    GstProblem problem() const;

    /// What elements have warned of last; empty: nothing.
    std::string warning() const;

    /// Ends it. Elements that do not end within a few seconds are left to themselves: their thread stays.
    void stop();

    static constexpr int most_left = 2;

private:
    std::shared_ptr<StereoPipelineState> state_;
    bool started_ = false;
};

}  // namespace disparityd::capture
