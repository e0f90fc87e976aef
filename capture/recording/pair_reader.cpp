// SPDX-License-Identifier: Apache-2.0
#include "capture/recording/pair_reader.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "base/message_text.h"
#include "base/words.h"
#include "capture/frame_source.h"
#include "capture/pixel_format.h"

namespace disparityd::capture {
namespace {

std::string picture_text(const RecordingReader::Info& info) {
    return base::size_text(2 * info.eye_width, info.height) + " " + std::string(to_string(info.format));
}

}  // namespace

PairReader::PairReader(std::unique_ptr<RecordingReader> left, std::unique_ptr<RecordingReader> right, std::string name,
                       std::vector<std::string> notices)
    : name_(std::move(name)), left_{std::move(left), {}, {}}, right_{std::move(right), {}, {}} {
    const Info& a = left_.reader->info();
    const Info& b = right_.reader->info();
    if (a.eye_width != b.eye_width || a.height != b.height || a.format != b.format) {
        throw std::invalid_argument(name_ + ": the videos of the two eyes must be alike, found " + picture_text(a) +
                                    " and " + picture_text(b));
    }
    left_.pixels.resize(left_.reader->frame_bytes());
    right_.pixels.resize(right_.reader->frame_bytes());
    info_ = a;
    info_.eye_width = 2 * a.eye_width;
    info_.notices = std::move(notices);
    if (info_.frame_count && b.frame_count) {
        info_.frame_count = std::min(*info_.frame_count, *b.frame_count);
    }
    half_period_ns_ = a.rate > 0 ? std::llround(0.5e9 / a.rate) : 0;
}

/// Reads a picture of each eye, and further ones of the eye that is behind until they belong together.
bool PairReader::find_pair(std::uint32_t& lost) {
    if (!left_.next()) {
        check_rest(right_);
        return false;
    }
    if (!right_.next()) {
        check_rest(left_);
        return false;
    }
    for (;;) {
        const auto apart =
            static_cast<double>(left_.facts.monotonic_ns) - static_cast<double>(right_.facts.monotonic_ns);
        if (half_period_ns_ == 0 || std::abs(apart) <= static_cast<double>(half_period_ns_)) {
            lost += left_.facts.dropped_before;
            return true;
        }
        OneEye& behind = apart < 0 ? left_ : right_;
        lost += &behind == &left_ ? 1 + left_.facts.dropped_before : 0;
        if (!behind.next()) {
            check_rest(&behind == &left_ ? right_ : left_);
            return false;
        }
    }
}

/// Two cameras seldom stop at the same picture; a video that goes on for more than a second is another matter.
void PairReader::check_rest(OneEye& longer) const {
    const double second = info_.rate > 0 ? info_.rate : 30;
    std::uint64_t more = 0;
    while (static_cast<double>(more) <= second && longer.next()) {
        ++more;
    }
    if (static_cast<double>(more) > second) {
        throw std::runtime_error(name_ + ": the video of the " + (&longer == &left_ ? "right" : "left") +
                                 " eye ends first, by more than a second: " + base::counted(pairs_, "pair"));
    }
}

bool PairReader::read(recording::FrameFacts& facts, std::uint8_t* pixels) {
    std::uint32_t lost = 0;
    if (!find_pair(lost)) {
        return false;
    }
    const std::size_t row = 2 * static_cast<std::size_t>(left_.reader->info().eye_width) *
                            static_cast<std::size_t>(bytes_per_pixel(info_.format));
    for (std::size_t y = 0; y < static_cast<std::size_t>(info_.height); ++y) {
        std::memcpy(pixels + 2 * y * row, left_.pixels.data() + y * row, row);
        std::memcpy(pixels + (2 * y + 1) * row, right_.pixels.data() + y * row, row);
    }
    next_sequence_ += lost;
    facts = left_.facts;
    facts.sequence = next_sequence_++;
    facts.dropped_before = lost;
    facts.flags = left_.facts.flags | right_.facts.flags | (lost > 0 ? frame_flag_discontinuity : frame_flag_none);
    ++pairs_;
    return true;
}

}  // namespace disparityd::capture
