// SPDX-License-Identifier: Apache-2.0
#include "capture/gstreamer/gst_opened.h"

#include <algorithm>
#include <cctype>
#include <stdexcept>
#include <thread>

#include "base/number_text.h"

namespace disparityd::capture {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds slice{50};

/// Where a camera is waited for, the daemon may end meanwhile.
void check_stop(const SourceOptions& options, const GstStop& stop) {
    if (options.wait_for_camera && options.progress) {
        options.progress(0, 0);
    }
    if (stop && stop->load()) {
        throw std::runtime_error("source gst: interrupted");
    }
}

/// Waits for the first frame. Throws where there is none.
void wait_for_first(GstOpened& opened, const SourceOptions& options, const GstStop& stop) {
    const auto until = steady_clock::now() + longest_wait(options);
    for (;;) {
        check_stop(options, stop);
        switch (opened.frames->next(opened.first, std::min(until, steady_clock::now() + slice))) {
            case GstFrames::Got::picture: return;
            case GstFrames::Got::ended:
                if (opened.pipeline->feed().problem()) {
                    throw_problem(opened.pipeline->problem());
                }
                throw std::runtime_error("source gst: the pipeline has ended without a frame" +
                                         (opened.frames->what_came().empty() ? "" : ": " + opened.frames->what_came()));
            default: break;
        }
        if (steady_clock::now() >= until) {
            throw std::runtime_error("source gst: " +
                                     no_frame_text(*opened.pipeline, *opened.frames, longest_wait(options)));
        }
    }
}

/// Makes one attempt. `device` becomes whether another one may do better.
GstOpened attempt(const GstUri& uri, const SourceOptions& options, const GstStop& stop, bool& device) {
    GstOpened opened;
    opened.pipeline = std::make_unique<StereoPipeline>(uri.pipeline, most_waiting(options));
    opened.frames = std::make_unique<GstFrames>(*opened.pipeline, uri.within_ns);
    device = !opened.pipeline->devices().empty();
    opened.pipeline->start();
    wait_for_first(opened, options, stop);
    opened.live = opened.pipeline->ask_live();
    if (!opened.live && options.wait_for_camera && !opened.pipeline->devices().empty()) {
        throw std::invalid_argument("source gst: " + not_live_text(*opened.pipeline));
    }
    return opened;
}

}  // namespace

milliseconds longest_wait(const SourceOptions& options) {
    return 10 * options.stall_time;
}

std::size_t most_waiting(const SourceOptions& options) {
    return static_cast<std::size_t>(std::clamp(options.loans, 2, 4));
}

GstOpened open_gst_pipeline(const GstUri& uri, const SourceOptions& options, const GstStop& stop) {
    constexpr milliseconds longest_patience{60'000};
    constexpr milliseconds pause{1000};
    const bool patient = options.wait_for_camera && options.progress;
    const auto until = steady_clock::now() + std::min(60 * options.stall_time, longest_patience);
    for (std::string told;;) {
        bool device = false;
        try {
            return attempt(uri, options, stop, device);
        } catch (const std::runtime_error& error) {
            if (!patient || !device || steady_clock::now() + pause >= until) {
                throw;
            }
            if (options.report && !tell_the_same(told, error.what())) {
                told = error.what();
                options.report(told + "; it is tried again", true);
            }
        }
        const auto again = steady_clock::now() + std::min(pause, options.stall_time);
        while (steady_clock::now() < again) {
            check_stop(options, stop);
            std::this_thread::sleep_until(std::min(again, steady_clock::now() + slice));
        }
    }
}

std::string not_live_text(const StereoPipeline& pipeline) {
    return "found a source that does not say that it is live, " + pipeline.devices() +
           ": its pictures may be old; set is-live=true or do-timestamp=true at it, or use a live source";
}

std::string no_frame_text(const StereoPipeline& pipeline, const GstFrames& frames, milliseconds waited) {
    std::string text = "no frame has come for " + base::number_text(static_cast<double>(waited.count()) / 1000) + " s";
    for (const std::string& more : {frames.what_came(), pipeline.warning(), last_gst_warning()}) {
        text += more.empty() ? "" : "; " + more;
    }
    return text;
}

bool tell_the_same(const std::string& one, const std::string& other) {
    const auto words = [](std::string text) {
        std::erase_if(text, [](unsigned char c) { return std::isdigit(c) != 0; });
        return text;
    };
    return words(one) == words(other);
}

void throw_problem(const GstProblem& problem) {
    if (problem.users) {
        throw std::invalid_argument("source gst: " + problem.text);
    }
    throw std::runtime_error("source gst: " + problem.text);
}

}  // namespace disparityd::capture
