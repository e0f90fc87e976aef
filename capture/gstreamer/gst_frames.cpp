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

/// How many times the period of its rate a picture comes after an earlier one; 0 where the rate is unknown.
double periods_between(std::int64_t earlier_ns, const GstArrival& later) {
    return static_cast<double>(*later.running_ns - earlier_ns) * later.picture.rate / 1e9;
}

}  // namespace

GstPicturesChanged::GstPicturesChanged(const GstPicture& before, const GstPicture& after)
    : std::runtime_error("source gst: the pictures change from " + size_of(before) + " to " + size_of(after) +
                         " or to another format; put videoconvert, videoscale and caps in front of the appsink"),
      now(after) {}

GstFrames::GstFrames(StereoPipeline& pipeline, std::int64_t within_ns)
    : pipeline_(pipeline), feed_(pipeline.feed()), within_ns_(within_ns) {
    if (pipeline.has_two_sinks()) {
        pairs_.emplace(within_ns);
    }
}

GstFrames::Got GstFrames::next(std::optional<GstFrame>& frame, std::chrono::steady_clock::time_point deadline) {
    const bool two = pipeline_.has_two_sinks();
    for (bool all_came = change_ && feed_.live();;) {
        if (auto pair = pairs_ ? pairs_->take(all_came) : std::nullopt) {
            frame = frame_of(std::move(pair->left), std::move(pair->right));
            return Got::picture;
        }
        const std::array<bool, 2> eyes = two ? wanted() : std::array<bool, 2>{true, false};
        if (all_came) {
            if (change_) {
                throw GstPicturesChanged(*change_);
            }
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
                all_came = change_ && feed_.live();
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
        return !ended[one] && !changed_[one] && (live || ended[1 - one] || pairs_->waiting(eye) < most_ahead);
    };
    return {wants(Eye::left), wants(Eye::right)};
}

void GstFrames::add(Eye eye, GstArrival arrival) {
    const char* const name = eye == Eye::left ? "left" : "right";
    const auto stamp = stamp_of(arrival);
    if (!stamp) {
        throw std::invalid_argument(std::string("source gst: the buffers of appsink ") + name +
                                    " have no time stamps, and pairs are made by these: name a rate in the caps, as "
                                    "image/png,framerate=15/1, or set do-timestamp=true at a live source");
    }
    check_picture(eye, arrival.picture);
    if (!changed_[static_cast<std::size_t>(eye)]) {
        arrival.stamp_ns = *stamp;
        pairs_->add(eye, std::move(arrival));
    }
}

/// Pictures of an eye that change end the pairs; those of two eyes that differ from the beginning are refused.
void GstFrames::check_picture(Eye eye, const GstPicture& picture) {
    std::optional<GstPicture>& mine = pictures_[static_cast<std::size_t>(eye)];
    const std::optional<GstPicture>& others = pictures_[eye == Eye::left ? 1 : 0];
    const auto differs = [&](const GstPicture& other) {
        return picture.format != other.format || size_of(picture) != size_of(other);
    };
    if (mine) {
        if (differs(*mine)) {
            changed_[static_cast<std::size_t>(eye)] = true;
            change_ = change_.value_or(GstPicturesChanged(*mine, picture));
        }
        return;
    }
    mine = picture;
    if (!others) {
        return;
    }
    if (differs(*others)) {
        const std::string sizes = size_of(*pictures_[0]) + " and " + size_of(*pictures_[1]);
        throw std::invalid_argument(
            size_of(picture) == size_of(*others)
                ? "source gst: the appsinks left and right get different formats: name the same in the caps of both"
                : "source gst: found pictures of " + sizes +
                      " at the appsinks left and right, expected the same size: put videoscale and caps in front of "
                      "one");
    }
    if (picture.rate > 0 && others->rate > 0) {
        pairs_->set_interval(std::llround(1e9 / std::max(picture.rate, others->rate)));
    }
}

/// Pairs are made by this, also where it lies behind the arrival: both eyes may be delayed unequally.
std::optional<std::int64_t> GstFrames::stamp_of(const GstArrival& arrival) const {
    return feed_.live() && arrival.running_ns ? std::optional(arrival.base_ns + *arrival.running_ns)
                                              : arrival.running_ns;
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
    if (frame.stamp_ns && feed_.live() && *frame.stamp_ns > left.arrival_ns) {  // no frame is younger than its arrival
        frame.ahead_ns = *frame.stamp_ns - left.arrival_ns;
        frame.stamp_ns = left.arrival_ns;
    }
    frame.left = std::move(left);
    frame.right = std::move(right);
    return frame;
}

void GstFrames::take_over(Eye eye, const GstArrival& arrival, GstFrame& frame, std::uint64_t& lost) {
    std::optional<Seen>& seen = seen_[static_cast<std::size_t>(eye)];
    lost = std::max(lost, seen ? lost_of(arrival, *seen, frame.discontinuity) : arrival.dropped);
    frame.discontinuity = frame.discontinuity || (seen && has_gap(arrival, *seen, lost));
    seen = {arrival.number, arrival.running_ns, arrival.dropped, arrival.breaks};
}

/// Whether the stamps of frames without numbers, as behind a decoder, say that more are missing than are counted. It
/// may be the camera that takes fewer.
bool GstFrames::has_gap(const GstArrival& arrival, const Seen& seen, std::uint64_t lost) {
    if ((arrival.number && seen.number) || !arrival.running_ns || !seen.running_ns) {
        return false;
    }
    return periods_between(*seen.running_ns, arrival) > 1.5 + static_cast<double>(lost);
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
    const double missing = std::round(periods_between(*seen.running_ns, arrival)) - 1;
    return std::max(dropped, static_cast<std::uint64_t>(std::clamp(missing, 0.0, static_cast<double>(most))));
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
