// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "calibration/board/board.h"

namespace disparityd::tools {

/// A sheet of paper that lies on its long side; mm.
struct Paper {
    double width = 297;
    double height = 210;
};

/// Returns the sheet "a4" or "letter". Throws std::invalid_argument for another name.
Paper paper_of_name(const std::string& name);

/// Returns a PDF of one page: the board, below it a bar of 100 mm to check the printer with, and `lines` of ASCII text.
/// Its upper left square is black, as OpenCV 4.6 and later have it; markers count from 0, row by row. The same input
/// gives the same bytes. Throws std::invalid_argument with one line when the board does not fit on the paper.
std::string board_page(const calibration::Board& board, const Paper& paper, const std::vector<std::string>& lines);

}  // namespace disparityd::tools
