// SPDX-License-Identifier: Apache-2.0
#include "capture/gstreamer/gst_reader.h"

#include <cmath>
#include <stdexcept>
#include <utility>

namespace disparityd::capture {

GstReader::GstReader(GstOpened opened, const SourceOptions& options, GstStop stop)
    : opened_(std::move(opened)),
      longest_wait_(longest_wait(options)),
      stop_(std::move(stop)),
      picture_(opened_.first->left.picture) {
    info_.content = opened_.first->right ? "GStreamer pipeline of two eyes" : "GStreamer pipeline";
    info_.format = picture_.format;
    info_.eye_width = opened_.first->eye_width();
    info_.height = picture_.height;
    info_.rate = picture_.rate;
    if (!opened_.pipeline->devices().empty()) {
        info_.notices.push_back("source gst: " + not_live_text(*opened_.pipeline) + "; it is played as a recording");
    }
    if (!opened_.first->stamp_ns) {
        info_.notices.push_back(std::string("source gst: the buffers have no time stamps: ") +
                                (info_.rate > 0 ? "frames are timed by the rate in the caps"
                                                : "frames come as fast as they are taken; name a rate in the caps, as "
                                                  "image/png,framerate=15/1"));
    }
}

std::size_t GstReader::frame_bytes() const {
    return 2 * static_cast<std::size_t>(info_.eye_width) * static_cast<std::size_t>(info_.height) *
           static_cast<std::size_t>(bytes_per_pixel(info_.format));
}

void GstReader::interrupt() noexcept {
    stop_->store(true);
    opened_.pipeline->feed().wake();
}

bool GstReader::read(recording::FrameFacts& facts, std::uint8_t* pixels) {
    std::optional<GstFrame> frame = opened_.first ? std::exchange(opened_.first, std::nullopt) : next_frame();
    if (!frame) {
        return false;
    }
    const GstPicture& now = frame->left.picture;
    if (now.format != picture_.format || now.width != picture_.width || now.height != picture_.height) {
        throw GstPicturesChanged(picture_, now);
    }
    GstFrames::put_pixels(*frame, pixels);
    facts = recording::FrameFacts();
    sequence_ += frame->lost_before;
    facts.sequence = sequence_++;
    facts.dropped_before = frame->lost_before;
    facts.flags = (frame->corrupt() ? frame_flag_corrupt : 0U) |
                  (frame->discontinuity || frame->lost_before > 0 ? frame_flag_discontinuity : 0U);
    set_time(*frame, facts);
    opened_.frames->recycle(std::move(*frame));
    return true;
}

std::optional<GstFrame> GstReader::next_frame() try {
    const auto until = std::chrono::steady_clock::now() + longest_wait_;
    std::optional<GstFrame> frame;
    while (!stop_->load()) {
        switch (opened_.frames->next(frame, until)) {
            case GstFrames::Got::picture: return frame;
            case GstFrames::Got::ended:
                if (opened_.pipeline->feed().problem()) {
                    throw std::runtime_error("source gst: " + opened_.pipeline->problem().text);
                }
                return std::nullopt;
            case GstFrames::Got::timeout:
                throw std::runtime_error("source gst: " +
                                         no_frame_text(*opened_.pipeline, *opened_.frames, longest_wait_));
            default: break;
        }
    }
    return std::nullopt;
} catch (const std::invalid_argument& error) {  // it was well at the start: the file is to blame
    throw std::runtime_error(error.what());
}

/// A frame without a stamp comes one period after the one before, and one more for each that was lost between.
void GstReader::set_time(const GstFrame& frame, recording::FrameFacts& facts) {
    if (frame.stamp_ns) {
        first_ns_ = first_ns_.value_or(*frame.stamp_ns);
        last_ns_ = *frame.stamp_ns - *first_ns_;
    } else if (facts.sequence > 0 && info_.rate > 0) {
        last_ns_ += (std::int64_t{frame.lost_before} + 1) * std::llround(1e9 / info_.rate);
    }
    facts.monotonic_ns = last_ns_;
    facts.realtime_ns = last_ns_;
}

}  // namespace disparityd::capture
