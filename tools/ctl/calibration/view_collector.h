// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "calibration/board/board.h"
#include "calibration/board/other_board.h"
#include "capture/frame_source.h"
#include "capture/images/image_sequence.h"
#include "tools/ctl/calibration/calibration_report.h"

namespace disparityd::tools {

/// Collects views of a board from the frames of a source, and guides the person who holds it, on standard error.
class ViewCollector {
public:
    /// `source`: as the user called it. Of its frames, which have the size that `info` says, each `every`-th is looked
    /// at, until there are `wanted` views.
    ViewCollector(const std::string& source, const calibration::Board& board, const capture::SourceInfo& info,
                  int wanted, int every);

    bool enough() const { return views_.size() >= wanted_; }

    void look_at(const capture::RawFrame& frame);

    /// Returns one line on another board that the frames have shown; empty: none is known.
    std::string other_board() const { return other_board_.finding(); }

    const std::vector<calibration::BoardView>& views() const { return views_; }
    const std::vector<ViewPicture>& pictures() const { return pictures_; }

private:
    void look_for_other_board(Plane<const std::uint8_t> eye);
    std::string name_of(const capture::RawFrame& frame) const;
    std::string progress() const;
    void say(const capture::RawFrame& frame, const std::string& text);

    const calibration::Board board_;
    const int width_;
    const int height_;
    const std::size_t wanted_;
    const std::uint64_t every_;
    std::vector<capture::ImageSequence::Frame> images_;  ///< empty: the source does not consist of images
    calibration::OtherBoard other_board_;
    int looks_ = 0;  ///< for another board
    std::uint64_t frame_number_ = 0;
    std::string said_;
    std::vector<calibration::BoardView> views_;
    std::vector<ViewPicture> pictures_;
};

}  // namespace disparityd::tools
