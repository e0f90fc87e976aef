// SPDX-License-Identifier: Apache-2.0
#include "capture/gstreamer/gst_feed.h"

#include <algorithm>
#include <exception>
#include <utility>

#include "base/failure_text.h"

namespace disparityd::capture {
namespace {

using std::chrono::steady_clock;

std::optional<std::int64_t> running_time(GstSample& sample, GstBuffer* buffer) {
    const GstSegment* const segment = gst_sample_get_segment(&sample);
    if (!GST_BUFFER_PTS_IS_VALID(buffer) || segment == nullptr || segment->format != GST_FORMAT_TIME) {
        return std::nullopt;
    }
    const guint64 running = gst_segment_to_running_time(segment, GST_FORMAT_TIME, GST_BUFFER_PTS(buffer));
    return GST_CLOCK_TIME_IS_VALID(running) ? std::optional(static_cast<std::int64_t>(running)) : std::nullopt;
}

/// Sources of video number their frames. What numbers bytes says how many a buffer has.
std::optional<std::uint64_t> number_of(GstBuffer* buffer) {
    const bool numbered = GST_BUFFER_OFFSET_IS_VALID(buffer) && GST_BUFFER_OFFSET_END_IS_VALID(buffer) &&
                          GST_BUFFER_OFFSET_END(buffer) == GST_BUFFER_OFFSET(buffer) + 1;
    return numbered ? std::optional<std::uint64_t>(GST_BUFFER_OFFSET(buffer)) : std::nullopt;
}

constexpr std::size_t most_spare = 8;

}  // namespace

GstFeed::GstFeed(std::size_t waiting, bool two_sinks) : most_(waiting), two_sinks_(two_sinks) {
    spare_.reserve(most_spare);
}

bool GstFeed::accept(Eye eye, GstSample& sample, std::int64_t base_ns) noexcept {
    const auto wanted = [this] {
        const std::lock_guard lock(mutex_);
        return !problem_ && !closed_;
    };
    if (!wanted()) {
        return false;
    }
    try {
        convert(eye, sample, base_ns);
    } catch (const std::invalid_argument& error) {
        fail({error.what(), true});
    } catch (const std::exception& error) {
        fail({base::failure_text(error), false});
    }
    return wanted();
}

void GstFeed::convert(Eye eye, GstSample& sample, std::int64_t base_ns) {
    OfEye& mine = of(eye);
    GstCaps* const caps = gst_sample_get_caps(&sample);
    GstBuffer* const buffer = gst_sample_get_buffer(&sample);
    if (caps == nullptr || buffer == nullptr) {
        throw std::runtime_error("a buffer came without caps");
    }
    if (mine.caps.get() != caps) {
        using Holds = GstConverter::Holds;
        mine.caps.reset();  // the converter is gone where these caps are refused
        mine.converter.emplace(*caps, !two_sinks_        ? Holds::both_eyes
                                      : eye == Eye::left ? Holds::left_eye
                                                         : Holds::right_eye);
        mine.caps.reset(gst_caps_ref(caps));
    }
    GstArrival arrival;
    arrival.arrival_ns = std::chrono::nanoseconds(steady_clock::now().time_since_epoch()).count();
    arrival.base_ns = base_ns;
    arrival.running_ns = running_time(sample, buffer);
    arrival.number = number_of(buffer);
    arrival.corrupt = GST_BUFFER_FLAG_IS_SET(buffer, GST_BUFFER_FLAG_CORRUPTED) != FALSE;
    arrival.picture = mine.converter->picture();
    arrival.pixels = memory(arrival.picture.bytes());
    if (!mine.converter->convert(buffer, arrival.pixels.data())) {
        throw std::runtime_error("a buffer of " + std::to_string(gst_buffer_get_size(buffer)) +
                                 " bytes is too short for its caps, " + caps_text(caps));
    }
    hand_over(eye, std::move(arrival), GST_BUFFER_FLAG_IS_SET(buffer, GST_BUFFER_FLAG_DISCONT) != FALSE);
}

std::vector<std::uint8_t> GstFeed::memory(std::size_t bytes) {
    std::vector<std::uint8_t> pixels;
    {
        const std::lock_guard lock(mutex_);
        if (!spare_.empty()) {
            pixels = std::move(spare_.back());
            spare_.pop_back();
        }
    }
    pixels.resize(bytes);
    return pixels;
}

void GstFeed::hand_over(Eye eye, GstArrival arrival, bool breaks) {
    OfEye& mine = of(eye);
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return live_ || closed_ || mine.waiting.size() < most_; });
    if (closed_) {
        return;
    }
    while (mine.waiting.size() >= most_) {
        keep_spare(std::move(mine.waiting.front().pixels));
        mine.waiting.pop_front();
        ++mine.dropped;
    }
    ++mine.arrived;
    mine.breaks += breaks ? 1 : 0;
    arrival.dropped = mine.dropped;
    arrival.breaks = mine.breaks;
    mine.waiting.push_back(std::move(arrival));
    changed_.notify_all();
}

void GstFeed::end(Eye eye) noexcept {
    const std::lock_guard lock(mutex_);
    of(eye).ended = true;
    changed_.notify_all();
}

void GstFeed::end() noexcept {
    const std::lock_guard lock(mutex_);
    ended_ = true;
    changed_.notify_all();
}

void GstFeed::fail(GstProblem problem) noexcept {
    const std::lock_guard lock(mutex_);
    if (!problem_) {
        problem_ = std::move(problem);
    }
    changed_.notify_all();
}

void GstFeed::add_lost(std::uint64_t frames) noexcept {
    const std::lock_guard lock(mutex_);
    lost_ += frames;
}

void GstFeed::set_live() noexcept {
    const std::lock_guard lock(mutex_);
    live_ = true;
    changed_.notify_all();
}

void GstFeed::wake() noexcept {
    const std::lock_guard lock(mutex_);
    woken_ = true;
    changed_.notify_all();
}

void GstFeed::close() noexcept {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    changed_.notify_all();
}

void GstFeed::forget() noexcept {
    const std::lock_guard lock(mutex_);
    for (OfEye& eye : eyes_) {
        eye.waiting.clear();
        eye.dropped = 0;
    }
    changed_.notify_all();
}

bool GstFeed::live() const {
    const std::lock_guard lock(mutex_);
    return live_;
}

std::uint64_t GstFeed::lost() const {
    const std::lock_guard lock(mutex_);
    return lost_;
}

std::uint64_t GstFeed::arrived(Eye eye) const {
    const std::lock_guard lock(mutex_);
    return of(eye).arrived;
}

std::optional<GstProblem> GstFeed::problem() const {
    const std::lock_guard lock(mutex_);
    return problem_;
}

GstFeed::Got GstFeed::take(std::array<bool, 2> wanted, Eye& eye, GstArrival& arrival,
                           steady_clock::time_point deadline) {
    std::unique_lock lock(mutex_);
    for (;;) {
        bool eye_ended = true;
        for (const Eye one : {Eye::left, Eye::right}) {
            OfEye& of_one = of(one);
            if (wanted[static_cast<std::size_t>(one)] && !of_one.waiting.empty()) {
                eye = one;
                arrival = std::move(of_one.waiting.front());
                of_one.waiting.pop_front();
                changed_.notify_all();
                return Got::picture;
            }
            eye_ended = eye_ended && (!wanted[static_cast<std::size_t>(one)] || of_one.ended);
        }
        if (ended_ || closed_ || problem_) {
            return Got::ended;
        }
        if (eye_ended) {
            return Got::eye_ended;
        }
        if (std::exchange(woken_, false)) {
            return Got::woken;
        }
        if (steady_clock::now() >= deadline) {
            return Got::timeout;
        }
        changed_.wait_until(lock, deadline);
    }
}

bool GstFeed::ended(Eye eye) const {
    const std::lock_guard lock(mutex_);
    const OfEye& one = of(eye);
    return one.waiting.empty() && (one.ended || ended_ || closed_ || problem_);
}

void GstFeed::recycle(std::vector<std::uint8_t> pixels) noexcept {
    const std::lock_guard lock(mutex_);
    keep_spare(std::move(pixels));
}

void GstFeed::keep_spare(std::vector<std::uint8_t> pixels) noexcept {
    if (spare_.size() < most_spare) {
        spare_.push_back(std::move(pixels));  // within its capacity
    }
}

}  // namespace disparityd::capture
