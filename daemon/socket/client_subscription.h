// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "daemon/published_frame.h"
#include "daemon/socket/frames/frame_compressor.h"
#include "daemon/socket/frames/frame_feed.h"
#include "daemon/socket/frames/sensor_ring.h"

namespace disparityd::daemon {

/// Counts how many frames a client may still be sent (Subscribe.by_credit). A client that reads slowly gives credit
/// slowly, so that no frame grows old on its way. One thread (the server's).
class FrameCredit {
public:
    /// More is not kept: a client cannot order a queue of old frames.
    static constexpr std::uint32_t most = 16;

    /// Begins without credit, or without a limit for a client that gives none.
    void start(bool by_credit) {
        limited_ = by_credit;
        left_ = 0;
    }

    void add(std::uint32_t frames) { left_ = std::min(most, left_ + std::min(most, frames)); }

    /// Counts a frame.
    void take() { left_ -= limited_ && left_ > 0 ? 1 : 0; }

    bool allows_one() const { return !limited_ || left_ > 0; }
    bool limited() const { return limited_; }

private:
    bool limited_ = false;
    std::uint32_t left_ = 0;
};

/// What one client wants of frames and samples, and how far it has got them. Used by the server's thread only.
class ClientSubscription {
public:
    /// A client that waits for the next status is not idle.
    static constexpr double longest_status_interval_s = 86400;

    /// Returns why a Subscribe is refused; empty: it is not. Before the first layout its products are not known, and
    /// only the interval of its statuses is looked at.
    static std::string problem(const v1::Subscribe& wanted, const StreamLayout& layout);

    /// Begins with the next frame and the next sample. `wanted` has no problem().
    void start(const v1::Subscribe& wanted, const FrameRing& frames, const SensorRing& samples);

    /// Keeps what came before the first layout; its credit counts from now on.
    void keep(const v1::Subscribe& wanted);
    bool keeps_one() const { return kept_.has_value(); }
    std::optional<v1::Subscribe> take_kept() { return std::exchange(kept_, std::nullopt); }

    std::uint32_t products() const { return selection_.product_bits(); }
    bool compressed() const { return selection_.encoding == v1::ZSTD; }
    bool sensors() const { return sensors_; }
    const Selection& selection() const { return selection_; }
    FrameFeed& feed() { return feed_; }
    const FrameFeed& feed() const { return feed_; }
    FrameCredit& credit() { return credit_; }
    const FrameCredit& credit() const { return credit_; }

    /// Removes the products that are not offered. Returns whether there were some.
    bool drop_products_not_in(const std::vector<v1::Product>& offered);

    struct Taken {
        FrameCompressor::Request request;  ///< its frame is null where there is none
        bool region_is_outside = false;    ///< of the image, which has become smaller: the subscription has ended
    };
    /// Takes the next frame of the feed, with the selection for it: the region is cut to the image.
    Taken take_frame(const FrameRing& frames);

    /// Fills the message with all new samples.
    void take_samples(const SensorRing& samples, v1::Sensors& message);
    bool has_samples(const SensorRing& samples) const { return sensors_ && next_sample_ != samples.end(); }

private:
    Selection selection_;
    FrameFeed feed_;
    FrameCredit credit_;
    bool sensors_ = false;
    std::uint64_t next_sample_ = 0;
    std::optional<v1::Subscribe> kept_;
};

}  // namespace disparityd::daemon
