// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "capture/gstreamer/gst_library.h"
#include "capture/gstreamer/gst_picture.h"

namespace disparityd::capture {

/// A picture that an appsink got, converted, with what its buffer says.
struct GstArrival {
    std::vector<std::uint8_t> pixels;  ///< rows without gaps
    GstPicture picture;
    std::optional<std::int64_t> running_ns;  ///< since the pipeline began to play; empty: the buffer has no time stamp
    std::int64_t base_ns = 0;                ///< when it began, on CLOCK_MONOTONIC
    std::int64_t arrival_ns = 0;             ///< CLOCK_MONOTONIC
    std::optional<std::uint64_t> number;     ///< of the frame, where the source counts them
    std::uint64_t dropped = 0;               ///< of this eye until now, because nobody took them
    std::uint64_t breaks = 0;                ///< of this eye until now: buffers that say that some were lost before
    bool corrupt = false;

    std::int64_t stamp_ns = 0;  ///< what pairs are made by; its owner sets it
    std::size_t bytes() const { return pixels.size(); }
};

/// Why a pipeline gives nothing more.
struct GstProblem {
    std::string text;    ///< one line, without the source's name
    bool users = false;  ///< the user must change something; else a device, a file or the system refuses
};

/// Hands pictures from the threads of GStreamer to the one that takes frames. Of a live pipeline the newest wait, and
/// those that nobody takes are counted; else GStreamer's thread waits.
class GstFeed {
public:
    /// At most so many pictures of each eye wait. Without two sinks those of the left one hold both eyes.
    GstFeed(std::size_t waiting, bool two_sinks);

    // Threads of GStreamer:
    /// Converts and hands over. False: the pictures cannot be taken, or nobody wants any more.
    bool accept(Eye eye, GstSample& sample, std::int64_t base_ns) noexcept;
    void end(Eye eye) noexcept;
    void end() noexcept;
    void fail(GstProblem problem) noexcept;        ///< the first one counts
    void add_lost(std::uint64_t frames) noexcept;  ///< that an element says it has left out
    void set_live() noexcept;

    // Any thread:
    void wake() noexcept;    ///< a waiting take() returns `woken`
    void close() noexcept;   ///< nothing more is accepted
    void forget() noexcept;  ///< what waits, and what was dropped, was never there
    bool live() const;
    std::uint64_t lost() const;  ///< as add_lost() says
    std::uint64_t arrived(Eye eye) const;
    std::optional<GstProblem> problem() const;

    enum class Got : std::uint8_t {
        picture,
        eye_ended,  ///< the wanted eyes have no more
        ended,      ///< nothing more comes, and nothing that is wanted waits
        timeout,
        woken,
    };
    /// Takes the next picture of the eyes that are wanted.
    Got take(std::array<bool, 2> wanted, Eye& eye, GstArrival& arrival, std::chrono::steady_clock::time_point deadline);
    bool ended(Eye eye) const;

    /// Takes memory back, for pictures to come.
    void recycle(std::vector<std::uint8_t> pixels) noexcept;

private:
    struct OfEye {
        std::deque<GstArrival> waiting;
        GstPtr<GstCaps> caps;  ///< that `converter` is for; of the eye's thread
        std::optional<GstConverter> converter;
        std::uint64_t arrived = 0;
        std::uint64_t dropped = 0;
        std::uint64_t breaks = 0;
        bool ended = false;
    };

    OfEye& of(Eye eye) { return eyes_[static_cast<std::size_t>(eye)]; }
    const OfEye& of(Eye eye) const { return eyes_[static_cast<std::size_t>(eye)]; }
    void convert(Eye eye, GstSample& sample, std::int64_t base_ns);
    std::vector<std::uint8_t> memory(std::size_t bytes);
    void hand_over(Eye eye, GstArrival arrival, bool breaks);
    void keep_spare(std::vector<std::uint8_t> pixels) noexcept;

    const std::size_t most_;
    const bool two_sinks_;
    mutable std::mutex mutex_;  ///< what follows, but for caps and converter
    std::condition_variable changed_;
    std::array<OfEye, 2> eyes_;
    std::vector<std::vector<std::uint8_t>> spare_;
    std::optional<GstProblem> problem_;
    std::uint64_t lost_ = 0;
    bool live_ = false;
    bool ended_ = false;
    bool closed_ = false;
    bool woken_ = false;
};

}  // namespace disparityd::capture
