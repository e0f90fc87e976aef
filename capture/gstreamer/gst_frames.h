// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "capture/frame_source.h"
#include "capture/gstreamer/stereo_pipeline.h"
#include "capture/stamp_pairs.h"

namespace disparityd::capture {

/// A picture of both eyes, or one of each, with what was lost before.
struct GstFrame {
    GstArrival left;  ///< or both eyes
    std::optional<GstArrival> right;
    std::uint32_t lost_before = 0;         ///< frames known to be lost since the one before
    bool discontinuity = false;            ///< some were lost, nobody knows how many
    std::optional<std::int64_t> stamp_ns;  ///< of a live pipeline CLOCK_MONOTONIC, else since it began
    std::int64_t ahead_ns = 0;             ///< so much later than its arrival was the stamp of a live one

    int eye_width() const { return right ? left.picture.width : left.picture.width / 2; }
    std::size_t bytes() const { return left.bytes() + (right ? right->bytes() : 0); }
    bool corrupt() const { return left.corrupt || (right && right->corrupt); }
};

/// The pictures of an eye have become others in the middle; the text is one line.
struct GstPicturesChanged : std::runtime_error {
    GstPicturesChanged(const GstPicture& before, const GstPicture& after);
    GstPicture now;
};

/// Makes frames of what the appsinks of a pipeline get: pairs by stamp of two. One thread uses an object; it must not
/// outlive the pipeline.
class GstFrames {
public:
    using Got = GstFeed::Got;

    GstFrames(StereoPipeline& pipeline, std::int64_t within_ns);

    /// Takes the next frame; `ended` comes after all that is whole. Throws std::invalid_argument with one line where
    /// the two eyes differ in size or format, or have no stamps; GstPicturesChanged, behind all pairs of those before,
    /// where one of two eyes has changed.
    Got next(std::optional<GstFrame>& frame, std::chrono::steady_clock::time_point deadline);

    /// Writes both eyes side by side, rows without gaps; `to` is GstFrame::bytes() long.
    static void put_pixels(const GstFrame& frame, std::uint8_t* to);

    /// Gives the frame's memory back for those to come.
    void recycle(GstFrame&& frame);

    /// Says what has come, for the message that no frame did.
    std::string what_came() const;

private:
    /// What was counted of an eye up to its last picture that was in a frame.
    struct Seen {
        std::optional<std::uint64_t> number;
        std::optional<std::int64_t> running_ns;
        std::uint64_t dropped = 0;
        std::uint64_t breaks = 0;
    };

    std::array<bool, 2> wanted() const;
    void add(Eye eye, GstArrival arrival);
    GstFrame frame_of(GstArrival left, std::optional<GstArrival> right);
    static std::uint64_t lost_of(const GstArrival& arrival, const Seen& seen, bool& discontinuity);
    static bool has_gap(const GstArrival& arrival, const Seen& seen, std::uint64_t lost);
    void take_over(Eye eye, const GstArrival& arrival, GstFrame& frame, std::uint64_t& lost);
    std::optional<std::int64_t> stamp_of(const GstArrival& arrival) const;
    void check_picture(Eye eye, const GstPicture& picture);

    StereoPipeline& pipeline_;
    GstFeed& feed_;
    const std::int64_t within_ns_;
    std::optional<StampPairs<GstArrival>> pairs_;        ///< of two sinks
    std::array<std::optional<GstPicture>, 2> pictures_;  ///< of each eye
    std::array<bool, 2> changed_{};                      ///< nothing more is taken of such an eye
    std::optional<GstPicturesChanged> change_;           ///< behind the pairs that wait
    std::array<std::optional<Seen>, 2> seen_;
    std::uint64_t lost_seen_ = 0;
};

}  // namespace disparityd::capture
