// SPDX-License-Identifier: Apache-2.0
#include "capture/recording/foreign_reader.h"

#include <cmath>
#include <stdexcept>
#include <utility>

#include "base/message_text.h"
#include "capture/frame_source.h"
#include "capture/recording/video_layout.h"

namespace disparityd::capture {
namespace {

constexpr AVRational in_nanoseconds{1, 1'000'000'000};

}  // namespace

ForeignReader::ForeignReader(RecordingInput input, int track, Picture picture)
    : VideoReader(std::move(input), track), picture_(picture) {
    check_layout();
    info_.rate = guessed_rate();
    if (stream().nb_frames > 0) {
        info_.frame_count = static_cast<std::uint64_t>(stream().nb_frames);
    }
    open_decoder(static_cast<AVPixelFormat>(stream().codecpar->format));
}

/// Whether a picture holds both eyes cannot be seen for sure. What says nothing is told; what is too narrow for two
/// eyes is not cut in two.
void ForeignReader::check_layout() {
    const VideoLayout layout = layout_of(stream());
    const std::string& path = input().path();
    if (layout.refusal && (picture_ == Picture::both_eyes || !layout.side_by_side)) {
        throw std::invalid_argument(path + ": " + *layout.refusal);
    }
    if (picture_ == Picture::one_eye || layout.side_by_side) {
        return;
    }
    const int width = stream().codecpar->width;
    const int height = stream().codecpar->height;
    if (width / 2 < height) {
        throw std::invalid_argument(
            path + ": found a picture of " + base::size_text(width, height) +
            ", which is that of one eye; expected both eyes side by side, or the video of each: left.mp4,right.mp4. If "
            "it does hold both, let the file declare it: ffmpeg -i IN -c copy -metadata:s:v stereo_mode=left_right "
            "OUT.mkv");
    }
    info_.notices.push_back(path + ": declares no stereo layout; its left half is taken as the left eye, " +
                            base::size_text(width / 2, height));
}

double ForeignReader::guessed_rate() const {
    AVFormatContext& context = input().context();
    const AVRational rate = av_guess_frame_rate(&context, context.streams[stream().index], nullptr);
    return rate.num > 0 && rate.den > 0 ? recording::plausible_rate(av_q2d(rate)) : 0;
}

bool ForeignReader::accept(const AVPacket& packet) {
    cut_packet_ = (packet.flags & AV_PKT_FLAG_CORRUPT) != 0;
    if (cut_packet_) {
        // Inside a video a picture is lost; whether the file ends here shows when nothing follows.
        ++undecodable_;
        undecodable_why_ = "pictures are incomplete";
    }
    return !cut_packet_;
}

/// Videos cut out of longer ones begin with pictures that cannot be decoded: lost frames, not a fault.
void ForeignReader::refused(int error) {
    ++undecodable_;
    undecodable_why_ = ffmpeg_reason(error);
}

recording::FrameFacts ForeignReader::take_facts(const AVFrame& frame) {
    if (const auto refusal = frames() == 0 ? layout_of(frame).refusal : std::nullopt) {
        throw std::runtime_error(input().path() + ": " + *refusal);
    }
    recording::FrameFacts facts;
    next_sequence_ += undecodable_;
    facts.dropped_before = undecodable_;
    facts.sequence = next_sequence_++;
    if (undecodable_ > 0) {
        facts.flags |= frame_flag_discontinuity;
    }
    const std::uint32_t lost = std::exchange(undecodable_, 0);
    if ((frame.flags & AV_FRAME_FLAG_CORRUPT) != 0 || frame.decode_error_flags != 0) {
        facts.flags |= frame_flag_corrupt;
    }
    set_time(frame, lost);
    facts.monotonic_ns = last_time_ns_;
    facts.realtime_ns = last_time_ns_;
    return facts;
}

/// Sets the frame's distance from the first one; a frame without a time comes one period after its predecessor, and one
/// more for each picture that was lost between them.
void ForeignReader::set_time(const AVFrame& frame, std::uint32_t lost) {
    const std::int64_t pts = frame.best_effort_timestamp;
    if (pts != AV_NOPTS_VALUE) {
        first_pts_ = first_pts_.value_or(pts);
        // Unsigned, here and below: a damaged file may hold any two times.
        const std::uint64_t apart = static_cast<std::uint64_t>(pts) - static_cast<std::uint64_t>(*first_pts_);
        last_time_ns_ = av_rescale_q(static_cast<std::int64_t>(apart), stream().time_base, in_nanoseconds);
    } else if (frames() > 0 && info_.rate > 0) {
        last_time_ns_ = static_cast<std::int64_t>(static_cast<std::uint64_t>(last_time_ns_) +
                                                  (std::uint64_t{lost} + 1) *
                                                      static_cast<std::uint64_t>(std::llround(1e9 / info_.rate)));
    }
}

void ForeignReader::check_end() const {
    check_file_size();
    if (cut_packet_) {
        fail_truncated("the next one is incomplete");
    }
    check_end_error();
    if (frames() == 0 && undecodable_ > 0) {
        throw std::runtime_error(input().path() + ": no frame can be decoded: " + undecodable_why_);
    }
}

}  // namespace disparityd::capture
