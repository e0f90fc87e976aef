// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/calibration/view_collector.h"

#include <filesystem>
#include <iostream>

#include "calibration/board/coverage.h"
#include "kernels/raw_image.h"
#include "kernels/reference/steps.h"
#include "tools/command_line/table.h"

namespace disparityd::tools {
namespace {

/// The board must move by this part of the image's width to be another view.
constexpr double least_way = 0.02;

/// Owns the luma of both eyes of a raw frame, not rectified.
class LumaPair {
public:
    explicit LumaPair(const RawImage& raw);

    Plane<const std::uint8_t> left() const { return {left_.data(), width_, height_, width_}; }
    Plane<const std::uint8_t> right() const { return {right_.data(), width_, height_, width_}; }

private:
    int width_;
    int height_;
    std::vector<std::uint8_t> left_;
    std::vector<std::uint8_t> right_;
};

LumaPair::LumaPair(const RawImage& raw)
    : width_(raw.eye_width),
      height_(raw.height),
      left_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_)),
      right_(left_.size()) {
    const Rectifier as_it_is;
    reference::rectify(raw, Eye::left, as_it_is, {left_.data(), width_, height_, width_}, {0, height_});
    reference::rectify(raw, Eye::right, as_it_is, {right_.data(), width_, height_, width_}, {0, height_});
}

std::string file_name(const std::string& path) {
    return std::filesystem::path(path).filename().string();
}

}  // namespace

ViewCollector::ViewCollector(const std::string& source, const calibration::Board& board,
                             const capture::SourceInfo& info, int wanted, int every)
    : board_(board),
      width_(info.eye_width),
      height_(info.height),
      wanted_(static_cast<std::size_t>(wanted)),
      every_(static_cast<std::uint64_t>(every)),
      other_board_(board) {
    if (capture::is_image_sequence(source)) {
        images_ = capture::find_images(capture::parse_image_uri(source).path).frames;
    }
}

void ViewCollector::look_at(const capture::RawFrame& frame) {
    if (frame_number_++ % every_ != 0) {
        return;
    }
    const LumaPair eyes(frame.image);
    const auto view = calibration::find_board(eyes.left(), eyes.right(), board_);
    look_for_other_board(eyes.left());
    if (!view) {
        const std::string other = other_board();
        say(frame, !other.empty()   ? other
                   : board_.markers ? "both eyes see too little of the board"
                                    : "the board is not seen whole by both eyes");
        return;
    }
    if (!views_.empty() && calibration::moved(views_.back(), *view) < least_way * width_) {
        say(frame, "the board has not moved");
        return;
    }
    views_.push_back(*view);
    pictures_.push_back(shrink(eyes.left(), eyes.right()));
    pictures_.back().frame = name_of(frame);
    say(frame, progress());
}

/// A board with more corners than told may be found in part: the first frames are looked at in any case.
void ViewCollector::look_for_other_board(Plane<const std::uint8_t> eye) {
    constexpr int looks = 3;
    constexpr int looks_without_view = 6;
    if (looks_ < (views_.empty() ? looks_without_view : looks)) {
        other_board_.look_at(eye);
        ++looks_;
    }
}

/// Names a frame: by its files where the source consists of images, else by its number.
std::string ViewCollector::name_of(const capture::RawFrame& frame) const {
    if (frame.sequence >= images_.size()) {
        return "frame " + std::to_string(frame.sequence);
    }
    const auto& files = images_[frame.sequence];
    const std::string left = file_name(files.left);
    const std::string right = file_name(files.right);
    return right.empty() || right == left ? left : left + ", " + right;
}

std::string ViewCollector::progress() const {
    const auto missing = calibration::missing_views(views_, board_, width_, height_);
    const calibration::Coverage seen = calibration::coverage_of(views_, width_, height_);
    return "view " + std::to_string(views_.size()) + " of " + std::to_string(wanted_) + ", covered left " +
           fixed(100 * seen.left.ratio, 0) + " %, right " + fixed(100 * seen.right.ratio, 0) + " %" +
           (missing.empty() ? "" : "; " + missing.front());
}

/// Prints a line of guidance, unless it is the same as the line before.
void ViewCollector::say(const capture::RawFrame& frame, const std::string& text) {
    if (text != said_) {
        std::cerr << name_of(frame) << ": " << text << '\n';
        said_ = text;
    }
}

}  // namespace disparityd::tools
