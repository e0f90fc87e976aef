// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <string>

#include "capture/frame_source.h"
#include "capture/gstreamer/gst_frames.h"
#include "capture/gstreamer/gst_uri.h"
#include "capture/gstreamer/stereo_pipeline.h"

namespace disparityd::capture {

/// A pipeline that plays, with its first frame.
struct GstOpened {
    std::unique_ptr<StereoPipeline> pipeline;
    std::unique_ptr<GstFrames> frames;
    std::optional<GstFrame> first;
    bool live = false;
};

/// Set by another thread to end what waits.
using GstStop = std::shared_ptr<std::atomic<bool>>;

/// How long the first frame is waited for, and each frame of a file.
std::chrono::milliseconds longest_wait(const SourceOptions& options);

/// What a pipeline is made of at most waits of each eye.
std::size_t most_waiting(const SourceOptions& options);

/// Makes a pipeline, lets it play, and waits for its first frame. SourceOptions::progress is called meanwhile where a
/// camera is waited for. Throws as open_gst(), and std::runtime_error where `stop` is set.
GstOpened open_gst_pipeline(const GstUri& uri, const SourceOptions& options, const GstStop& stop = nullptr);

/// Says that no frame has come in so long, with what is known of the cause.
std::string no_frame_text(const StereoPipeline& pipeline, const GstFrames& frames, std::chrono::milliseconds waited);

/// Says that devices or the network are not live, of a pipeline that has such sources.
std::string not_live_text(const StereoPipeline& pipeline);

/// Whether two messages say the same: GStreamer numbers the elements of each pipeline anew.
bool tell_the_same(const std::string& one, const std::string& other);

/// Throws what a problem is.
[[noreturn]] void throw_problem(const GstProblem& problem);

}  // namespace disparityd::capture
