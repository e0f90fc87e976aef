// SPDX-License-Identifier: Apache-2.0
#include "calibration/board/verdict.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "base/words.h"
#include "calibration/online/epipolar_fit.h"

namespace disparityd::calibration {
namespace {

/// A view with more than so many times the median's error is bad, once that is more than corners of a good one vary by.
constexpr double far_from_the_rest = 3;
constexpr double unsuspicious_px = 0.3;
constexpr std::size_t least_to_compare = 8;

/// What a good calibration has, and what a usable one has at least. Half a pixel between the rows costs matches
/// (docs/benchmarks/calibration.md, self-calibration); corners are found to 0.1 to 0.3 px. Of the images 40 % are
/// covered by 13 views that reach into every part, as OpenCV's samples do: more adds little.
struct Limits {
    double rms_px;
    double rows_px;
    std::size_t views;
    double covered;
};
constexpr Limits good{0.5, 0.25, 10, 0.4};
constexpr Limits usable{1, 0.5, 5, 0.25};

double error_of(const BoardCalibration::View& view) {
    return std::max({view.left_rms, view.right_rms, view.rows});
}

double median_error(const BoardCalibration& found) {
    std::vector<double> errors;
    for (const BoardCalibration::View& view : found.views) {
        errors.push_back(error_of(view));
    }
    return median(errors);
}

double mean_row_error(const BoardCalibration& found) {
    const double sum = std::accumulate(found.views.begin(), found.views.end(), 0.0,
                                       [](double so_far, const auto& view) { return so_far + view.rows; });
    return sum / static_cast<double>(found.views.size());
}

/// Collects reasons; the worst of them is the verdict.
class Judge {
public:
    /// `is_good`, `is_usable`: whether what `reason` tells is.
    void look_at(bool is_good, bool is_usable, std::string reason) {
        if (!is_good) {
            result_.verdict = std::max(result_.verdict, is_usable ? Verdict::usable : Verdict::repeat);
            result_.reasons.push_back(std::move(reason));
        }
    }

    void look_at_eye(const char* name, const EyeCoverage& eye) {
        const auto missing = std::count(eye.parts.begin(), eye.parts.end(), false);
        look_at(eye.ratio >= good.covered, eye.ratio >= usable.covered,
                fmt::format("the boards covered {:.0f} % of the {} eye's image, {:.0f} % are good", 100 * eye.ratio,
                            name, 100 * good.covered));
        look_at(missing == 0, true,
                fmt::format("{} of {} parts of the {} eye's image have no corner: distortion is not measured there",
                            missing, coverage_parts, name));
    }

    Judgement result() && { return std::move(result_); }

private:
    Judgement result_;
};

}  // namespace

std::vector<std::size_t> bad_views(const BoardCalibration& found, std::size_t most) {
    if (found.views.size() < least_to_compare) {
        return {};
    }
    const double limit = std::max(unsuspicious_px, far_from_the_rest * median_error(found));
    std::vector<std::size_t> bad;
    for (std::size_t i = 0; i < found.views.size(); ++i) {
        if (error_of(found.views[i]) > limit) {
            bad.push_back(i);
        }
    }
    std::stable_sort(bad.begin(), bad.end(),
                     [&](std::size_t a, std::size_t b) { return error_of(found.views[a]) > error_of(found.views[b]); });
    bad.resize(std::min(bad.size(), most));
    std::sort(bad.begin(), bad.end());
    return bad;
}

const char* to_string(Verdict verdict) {
    switch (verdict) {
        case Verdict::good: return "good";
        case Verdict::usable: return "usable";
        case Verdict::repeat: return "repeat";
    }
    return "";
}

Judgement judge(const BoardCalibration& found, const std::vector<BoardView>& views, const Board& board) {
    const StereoCalibration& cameras = found.calibration;
    Judge judge;
    judge.look_at(found.rms <= good.rms_px, found.rms <= usable.rms_px,
                  fmt::format("the corners are {:.2f} px from where the cameras see them (RMS), {} px are good: take "
                              "sharper views, of a flat board that does not move",
                              found.rms, good.rms_px));
    const double rows = mean_row_error(found);
    judge.look_at(
        rows <= good.rows_px, rows <= usable.rows_px,
        fmt::format("rows of the eyes are {:.2f} px apart after rectification, {} px are good: hold the board "
                    "still, as the eyes may not be exposed at the same instant",
                    rows, good.rows_px));
    judge.look_at(views.size() >= good.views, views.size() >= usable.views,
                  fmt::format("{} were used, {} are good", base::counted(views.size(), "view"), good.views));
    const Coverage coverage = coverage_of(views, cameras.width, cameras.height);
    judge.look_at_eye("left", coverage.left);
    judge.look_at_eye("right", coverage.right);
    std::vector<std::string> missing = missing_parts(coverage);
    for (std::string& line : missing_poses(views, board, cameras.width)) {
        judge.look_at(false, true, line);
        missing.push_back(std::move(line));
    }
    Judgement result = std::move(judge).result();
    result.coverage = coverage;
    result.missing = std::move(missing);
    return result;
}

CheckedCalibration calibrate_and_judge(const std::vector<BoardView>& views, const Board& board, int width, int height,
                                       BoardLens lens, bool all_views) {
    CheckedCalibration result;
    result.views = views;
    result.used.resize(views.size());
    std::iota(result.used.begin(), result.used.end(), std::size_t{0});
    result.found = calibrate(result.views, board, width, height, lens);
    const std::size_t most = all_views ? 0 : views.size() / 4;
    while (result.left_out.size() < most) {
        const std::size_t at_once = std::max<std::size_t>(1, views.size() / 20);
        const std::vector<std::size_t> bad = bad_views(result.found, std::min(at_once, most - result.left_out.size()));
        if (bad.empty()) {
            break;
        }
        for (auto index = bad.rbegin(); index != bad.rend(); ++index) {
            const auto at = static_cast<std::ptrdiff_t>(*index);
            result.left_out.push_back({result.used[*index], result.found.views[*index]});
            result.used.erase(result.used.begin() + at);
            result.views.erase(result.views.begin() + at);
        }
        result.found = calibrate(result.views, board, width, height, lens);
    }
    std::sort(result.left_out.begin(), result.left_out.end(),
              [](const auto& a, const auto& b) { return a.view < b.view; });
    result.judgement = judge(result.found, result.views, board);
    return result;
}

}  // namespace disparityd::calibration
