// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "calibration/board/board.h"
#include "calibration/board/coverage.h"

namespace disparityd::calibration {

/// Returns the views, by index, whose corners do not fit the cameras that all views give: blurred, misread, of a bent
/// board, or of eyes that were exposed at different instants. Their error is over 0.3 px and over three times the
/// median's. At most `most`, the worst ones; none of fewer than 8.
std::vector<std::size_t> bad_views(const BoardCalibration& found, std::size_t most);

enum class Verdict {
    good,
    usable,  ///< distances are right, but could be better or surer
    repeat,  ///< distances or matching would suffer
};

/// "good", "usable", "repeat".
const char* to_string(Verdict verdict);

struct Judgement {
    Verdict verdict = Verdict::good;
    std::vector<std::string> reasons;  ///< one line each: found, and what a good calibration has; none when it is good
    Coverage coverage;
    std::vector<std::string> missing;  ///< missing_views()
};

/// Judges a calibration by its errors, the number of its views and what they have shown. `views` are those that `found`
/// was made of.
Judgement judge(const BoardCalibration& found, const std::vector<BoardView>& views, const Board& board);

/// A calibration of the views that fit each other.
struct CheckedCalibration {
    BoardCalibration found;
    std::vector<std::size_t> used;  ///< which of the given views
    std::vector<BoardView> views;   ///< these, in the same order
    struct LeftOut {
        std::size_t view = 0;           ///< which of the given views
        BoardCalibration::View errors;  ///< before it was left out
    };
    std::vector<LeftOut> left_out;  ///< bad_views(), in the order of the views
    Judgement judgement;
};

/// Calibrates, leaves the worst of bad_views() out, calibrates again, until none is bad or a quarter is left out, and
/// judges the result: a view that is far off bends the cameras, and then good ones have errors, too. `all_views`: none
/// is left out. Throws as calibrate().
CheckedCalibration calibrate_and_judge(const std::vector<BoardView>& views, const Board& board, int width, int height,
                                       BoardLens lens, bool all_views);

}  // namespace disparityd::calibration
