// SPDX-License-Identifier: Apache-2.0
#include "capture/gstreamer/gst_frames.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "base/message_text.h"
#include "base/number_text.h"
#include "base/words.h"

namespace disparityd::capture {
namespace {

/// So many pictures of one eye wait for the other eye of files; StampPairs would drop what waits longer.
constexpr std::size_t most_ahead = 32;

std::string size_of(const GstPicture& picture) {
    return base::size_text(picture.width, picture.height);
}

}  // namespace

GstFrames::GstFrames(StereoPipeline& pipeline, std::int64_t within_ns)
    : pipeline_(pipeline), feed_(pipeline.feed()), within_ns_(within_ns) {}

GstFrames::Got GstFrames::next(std::optional<GstFrame>& frame, std::chrono::steady_clock::time_point deadline) {
    const bool two = pipeline_.has_two_sinks();
    for (bool all_came = false;;) {
        if (auto pair = pairs_ ? pairs_->take(all_came) : std::nullopt) {
            frame = frame_of(std::move(pair->left), std::move(pair->right));
            return Got::picture;
        }
        const std::array<bool, 2> eyes = two ? wanted() : std::array<bool, 2>{true, false};
        if (all_came) {
            return Got::ended;
        }
        if (!eyes[0] && !eyes[1]) {
            all_came = true;
            continue;
        }
        Eye eye = Eye::left;
        GstArrival arrival;
        switch (const Got got = feed_.take(eyes, eye, arrival, deadline)) {
            case Got::picture:
                if (!two) {
                    frame = frame_of(std::move(arrival), std::nullopt);
                    return Got::picture;
                }
                add(eye, std::move(arrival));
                break;
            case Got::eye_ended: all_came = !two || (feed_.ended(Eye::left) && feed_.ended(Eye::right)); break;
            case Got::ended: all_came = true; break;
            default: return got;
        }
    }
}

/// An eye of a file waits for the other one; a live one is taken as it comes.
std::array<bool, 2> GstFrames::wanted() const {
    const bool live = feed_.live();
    const std::array<bool, 2> ended{feed_.ended(Eye::left), feed_.ended(Eye::right)};
    const auto wants = [&](Eye eye) {
        const auto one = static_cast<std::size_t>(eye);
        return !ended[one] && (live || ended[1 - one] || !pairs_ || pairs_->waiting(eye) < most_ahead);
    };
    return {wants(Eye::left), wants(Eye::right)};
}

void GstFrames::add(Eye eye, GstArrival arrival) {
    const char* const name = eye == Eye::left ? "left" : "right";
    const auto stamp = stamp_of(arrival);
    if (!stamp) {
        throw std::invalid_argument(std::string("the buffers of appsink ") + name +
                                    " have no time stamps, and pairs are made by these: name a rate in the caps, as "
                                    "image/png,framerate=15/1, or set do-timestamp=true at a live source");
    }
    if (!first_) {
        first_ = arrival.picture;
        pairs_.emplace(within_ns_, first_->rate > 0 ? std::llround(1e9 / first_->rate) : 0);
    }
    const GstPicture& picture = arrival.picture;
    if (picture.format != first_->format || size_of(picture) != size_of(*first_)) {
        throw std::invalid_argument(
            size_of(picture) == size_of(*first_)
                ? "the appsinks left and right get different formats: name the same in the caps of both"
                : "found pictures of " + size_of(*first_) + " and " + size_of(picture) +
                      " at the appsinks left and right, expected the same size: put videoscale and caps in front of "
                      "one");
    }
    arrival.stamp_ns = *stamp;
    pairs_->add(eye, std::move(arrival));
}

std::optional<std::int64_t> GstFrames::stamp_of(const GstArrival& arrival) const {
    if (!feed_.live()) {
        return arrival.running_ns;
    }
    // No frame is younger than its arrival.
    return arrival.running_ns ? std::optional(std::min(arrival.base_ns + *arrival.running_ns, arrival.arrival_ns))
                              : std::nullopt;
}

GstFrame GstFrames::frame_of(GstArrival left, std::optional<GstArrival> right) {
    GstFrame frame;
    const std::uint64_t left_out = feed_.lost();
    std::uint64_t lost =
        std::max<std::uint64_t>(left_out - std::exchange(lost_seen_, left_out), pairs_ ? pairs_->take_unpaired() : 0);
    take_over(Eye::left, left, frame, lost);
    if (right) {
        take_over(Eye::right, *right, frame, lost);
    }
    frame.lost_before = static_cast<std::uint32_t>(std::min<std::uint64_t>(lost, UINT32_MAX));
    frame.stamp_ns = stamp_of(left);
    frame.left = std::move(left);
    frame.right = std::move(right);
    return frame;
}

void GstFrames::take_over(Eye eye, const GstArrival& arrival, GstFrame& frame, std::uint64_t& lost) {
    std::optional<Seen>& seen = seen_[static_cast<std::size_t>(eye)];
    lost = std::max(lost, seen ? lost_of(arrival, *seen, frame.discontinuity) : arrival.dropped);
    seen = {arrival.number, arrival.running_ns, arrival.dropped, arrival.breaks};
}

/// How many frames of an eye were lost since the one before, by all that tells it; the same loss may show twice.
std::uint64_t GstFrames::lost_of(const GstArrival& arrival, const Seen& seen, bool& discontinuity) {
    constexpr std::uint64_t most = 1'000'000;  // beyond, the numbers are not those of frames
    const std::uint64_t dropped = arrival.dropped - seen.dropped;
    if (arrival.number && seen.number && *arrival.number > *seen.number && *arrival.number - *seen.number <= most) {
        return std::max(dropped, *arrival.number - *seen.number - 1);
    }
    if (arrival.breaks == seen.breaks) {
        return dropped;
    }
    discontinuity = true;
    if (!arrival.running_ns || !seen.running_ns || arrival.picture.rate <= 0) {
        return dropped;
    }
    const double steps = static_cast<double>(*arrival.running_ns - *seen.running_ns) * arrival.picture.rate / 1e9;
    return std::max(dropped,
                    static_cast<std::uint64_t>(std::clamp(std::round(steps) - 1, 0.0, static_cast<double>(most))));
}

void GstFrames::put_pixels(const GstFrame& frame, std::uint8_t* to) {
    if (!frame.right) {
        std::memcpy(to, frame.left.pixels.data(), frame.left.pixels.size());
        return;
    }
    const std::size_t row = frame.left.picture.row_bytes();
    const std::uint8_t* left = frame.left.pixels.data();
    const std::uint8_t* right = frame.right->pixels.data();
    for (int y = 0; y < frame.left.picture.height; ++y, left += row, right += row, to += 2 * row) {
        std::memcpy(to, left, row);
        std::memcpy(to + row, right, row);
    }
}

void GstFrames::recycle(GstFrame&& frame) {
    feed_.recycle(std::move(frame.left.pixels));
    if (frame.right) {
        feed_.recycle(std::move(frame.right->pixels));
    }
}

std::string GstFrames::what_came() const {
    const std::uint64_t left = feed_.arrived(Eye::left);
    if (!pipeline_.has_two_sinks()) {
        return left == 0 ? "" : base::counted(left, "picture") + " came";
    }
    const std::uint64_t right = feed_.arrived(Eye::right);
    std::string text = base::counted(left, "picture") + " came to appsink left, " + std::to_string(right) + " to right";
    if (left > 0 && right > 0) {
        return text + ", none at most " + base::number_text(static_cast<double>(within_ns_) / 1e6) +
               " ms apart; gst?within_ms=20:... allows more";
    }
    return text + (feed_.live() ? "" : "; put a queue in front of each appsink where both are fed by one element");
}

}  // namespace disparityd::capture
