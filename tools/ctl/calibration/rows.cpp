// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "base/words.h"
#include "calibration/online/self_calibration.h"
#include "calibration/rectification.h"
#include "kernels/raw_image.h"
#include "kernels/reference/steps.h"
#include "pipeline/calibrating_schedule.h"
#include "tools/command_line/interrupt.h"
#include "tools/command_line/number_argument.h"
#include "tools/command_line/table.h"
#include "tools/ctl/calibration/row_offsets.h"
#include "tools/ctl/commands.h"
#include "tools/ctl/output_file.h"
#include "tools/ctl/source_arguments.h"
#include "tools/images/image_file.h"

namespace disparityd::tools {
namespace {

/// Holds a frame rectified in one way, and the corners that both of its eyes have.
class RowsOfPair {
public:
    /// `range`: the disparities at which corners are searched.
    RowsOfPair(const RawImage& frame, const calibration::Rectification& rectification, DisparityRange range);

    /// Returns the corners, without wrong matches, and how far their rows are apart.
    const RowOffsets& rows() const { return rows_; }

    cv::Mat left() const { return {height_, width_, CV_8U, const_cast<std::uint8_t*>(left_.data())}; }
    cv::Mat right() const { return {height_, width_, CV_8U, const_cast<std::uint8_t*>(right_.data())}; }

private:
    int width_;
    int height_;
    std::vector<std::uint8_t> left_;
    std::vector<std::uint8_t> right_;
    RowOffsets rows_;
};

using calibration::CornerMatch;

// Of a magnified place, px of the image.
constexpr int place_width = 33;
constexpr int place_height = 15;
constexpr int magnified = 6;
constexpr int gap = 8;
constexpr int text_height = 24;
constexpr int head_height = 2 * text_height;
constexpr int columns = 3;  // of places over the image
constexpr int rows = 2;

double distance(const CornerMatch& a, const CornerMatch& b) {
    return std::hypot(a.left_x - b.left_x, a.left_y - b.left_y);
}

struct Place {
    CornerMatch before;
    CornerMatch after;
};

/// Returns the corner nearest to the middle of each part of the image that both pictures have. A correction moves the
/// image by pixels.
std::vector<Place> choose(const RowsOfPair& before, const RowsOfPair& after) {
    constexpr double same = 12;
    std::vector<Place> places;
    for (int part = 0; part < columns * rows; ++part) {
        const int column = part % columns;
        const int row = part / columns;
        const CornerMatch middle{(column + 0.5) * before.left().cols / columns, (row + 0.5) * before.left().rows / rows,
                                 0, 0};
        std::optional<Place> best;
        for (const CornerMatch& match : before.rows().agreeing) {
            const auto nearest =
                std::min_element(after.rows().agreeing.begin(), after.rows().agreeing.end(),
                                 [&](const auto& a, const auto& b) { return distance(a, match) < distance(b, match); });
            if (nearest != after.rows().agreeing.end() && distance(*nearest, match) < same &&
                (!best || distance(match, middle) < distance(best->before, middle))) {
                best = {match, *nearest};
            }
        }
        if (best) {
            places.push_back(*best);
        }
    }
    return places;
}

void write_text(cv::Mat& picture, const std::string& text, int x, int y) {
    cv::putText(picture, text, {x, y}, cv::FONT_HERSHEY_SIMPLEX, 0.5, {255, 255, 255}, 1, cv::LINE_AA);
}

cv::Mat part_of(const cv::Mat& eye, double x, double row) {
    cv::Mat part;
    cv::getRectSubPix(eye, {place_width, place_height}, {static_cast<float>(x), static_cast<float>(row)}, part);
    return part;
}

/// Draws a place of one eye with the row of the left corner, and the corner `below` that row.
cv::Mat magnify(const cv::Mat& part, double below) {
    cv::Mat large;
    cv::resize(part, large, {}, magnified, magnified, cv::INTER_NEAREST);
    cv::cvtColor(large, large, cv::COLOR_GRAY2BGR);
    const cv::Point middle(large.cols / 2, large.rows / 2);
    cv::line(large, {0, middle.y}, {large.cols, middle.y}, {0, 220, 220});
    cv::drawMarker(large, middle + cv::Point(0, static_cast<int>(std::lround(below * magnified))), {0, 0, 255},
                   cv::MARKER_TILTED_CROSS, 16, 2);
    return large;
}

void show_pair(cv::Mat& picture, const RowsOfPair& pair, const CornerMatch& match, int x, int y) {
    cv::Mat both;
    cv::hconcat(part_of(pair.left(), match.left_x, match.left_y), part_of(pair.right(), match.right_x, match.left_y),
                both);
    cv::normalize(both, both, 0, 255, cv::NORM_MINMAX);
    const cv::Mat left = magnify(both.colRange(0, place_width), 0);
    const cv::Mat right = magnify(both.colRange(place_width, 2 * place_width), match.right_y - match.left_y);
    left.copyTo(picture(cv::Rect(x, y, left.cols, left.rows)));
    right.copyTo(picture(cv::Rect(x + left.cols, y, right.cols, right.rows)));
    write_text(picture, fixed(match.left_y - match.right_y, 2) + " px", x + 6, y + left.rows - 8);
}

void write_headline(cv::Mat& picture, const char* when, const RowsOfPair& pair, int x) {
    const RowOffsets& offsets = pair.rows();
    write_text(picture,
               std::string(when) + ": " + fixed(offsets.median, 2) + " px, median of " +
                   base::counted(offsets.agreeing.size(), "corner"),
               x, text_height - 7);
    write_text(picture, "wrong matches, left out: " + fixed(100 * offsets.wrong, 0) + " %", x, 2 * text_height - 7);
}

RowsOfPair::RowsOfPair(const RawImage& frame, const calibration::Rectification& rectification, DisparityRange range)
    : width_(rectification.width),
      height_(rectification.height),
      left_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_)),
      right_(left_.size()) {
    const Rectifier rectifier = rectification.rectifier();
    const Plane<std::uint8_t> left{left_.data(), width_, height_, width_};
    const Plane<std::uint8_t> right{right_.data(), width_, height_, width_};
    reference::rectify(frame, Eye::left, rectifier, left, {0, height_});
    reference::rectify(frame, Eye::right, rectifier, right, {0, height_});
    rows_ = row_offsets(calibration::match_corners(left, right, range, calibration::rows_searched(rectification.f)));
}

/// Draws six places of the image, magnified, left eye beside right eye: on the left as rectified before, on the right
/// as after. A line marks the left corner's row, a cross the corner in the right eye.
cv::Mat rows_picture(const RowsOfPair& before, const RowsOfPair& after) {
    const std::vector<Place> places = choose(before, after);
    const int half = 2 * place_width * magnified;
    const int row_height = place_height * magnified + gap;
    cv::Mat picture(head_height + std::max<int>(1, static_cast<int>(places.size())) * row_height, 2 * half + gap,
                    CV_8UC3, cv::Scalar::all(40));
    write_headline(picture, "before", before, 6);
    write_headline(picture, "after", after, half + gap + 6);
    int y = head_height;
    for (const Place& place : places) {
        show_pair(picture, before, place.before, 0, y);
        show_pair(picture, after, place.after, half + gap, y);
        y += row_height;
    }
    return picture;
}

constexpr int default_frames = 8;
constexpr int widest_disparity = 128;

struct RowsArguments {
    std::string source;
    std::string output;
    std::string calibration;
    std::optional<int> frames;
    std::optional<int> disparities;
    bool force = false;
};

int show_rows(const RowsArguments& arguments) {
    images::check_picture_name(arguments.output);
    check_output(arguments.output, arguments.force);
    capture::SourceOptions options;
    options.uri = arguments.source;
    options.loans = 2;
    options.pace = capture::Pace::fastest;
    options.calibration_path = arguments.calibration;
    const auto source = open_with_progress(options);
    const DisparityRange range{0, arguments.disparities.value_or(widest_disparity)};
    const int frames = arguments.frames.value_or(default_frames);
    pipeline::CalibratingSchedule schedule(source->info(), {}, range, {1, frames});
    catch_interrupts();
    std::optional<capture::RawFrame> last;
    std::shared_ptr<const calibration::Rectification> found;
    for (int i = 0; i < frames; ++i) {
        auto frame = next_frame(*source);
        if (!frame) {
            break;
        }
        if (last) {
            source->give_back(*last);
        }
        last = frame;
        found = schedule.for_frame(*last);
    }
    if (!last && interrupted()) {
        print_note("stopped by " + interrupted_by() + " before the first frame; nothing was written");
        return exit_interrupted;
    }
    if (!last) {
        throw std::runtime_error(arguments.source + ": there is no frame in it");
    }
    const RowsOfPair before(last->image, schedule.factory(), range);
    const RowsOfPair after(last->image, *found, range);
    source->give_back(*last);
    images::write_picture(arguments.output, rows_picture(before, after));
    std::cout << arguments.output << ": median |left y - right y| of the corners of the last frame "
              << fixed(before.rows().median, 2) << " px as calibrated, " << fixed(after.rows().median, 2)
              << " px self-calibrated; wrong matches, which are left out: " << fixed(100 * before.rows().wrong, 0)
              << " % and " << fixed(100 * after.rows().wrong, 0) << " %\n";
    for (const auto& [sequence, result] : schedule.estimates()) {
        std::cout << "frame " << sequence << ": " << (result.accepted ? "corrected" : "nothing changed") << ": "
                  << result.reason << '\n';
    }
    return exit_done;
}

}  // namespace

void add_rows(CLI::App& program, Action& action) {
    CLI::App& command = *program.add_subcommand(
        "rows", "Picture of how well the rows of a rectified pair agree, before and after self-calibration.");
    const auto arguments = std::make_shared<RowsArguments>();
    command
        .add_option("SOURCE", arguments->source, "raw pairs of cameras with a calibration; see disparityctl sources")
        ->required();
    command.add_option("-o,--output", arguments->output, "picture to write (.png, .jpg)")
        ->type_name("FILE")
        ->required();
    command.add_option("--calibration", arguments->calibration, "calibration instead of the source's own")
        ->type_name("FILE");
    add_integer(command, "--frames", arguments->frames, 1, 1000,
                "frames to look at; default " + std::to_string(default_frames));
    add_integer(command, "--disparities", arguments->disparities, 16, 256,
                "range of disparities in which corners are searched; default " + std::to_string(widest_disparity));
    command.add_flag("--force", arguments->force, "replace the file");
    command.footer(
        "The picture shows six places of the image, magnified six times, left eye beside right eye: on the left as\n"
        "the calibration rectifies them, on the right after self-calibration. A line marks the row of the left eye's\n"
        "corner, a cross the corner in the right eye: it lies on the line where the rows agree. Corners whose row\n"
        "offset differs by more than half a pixel from that of their surroundings are wrong matches: they are left\n"
        "out and counted.\n"
        "Example: disparityctl rows drive.mkv -o rows.png");
    command.callback([arguments, &action] { action = [arguments] { return show_rows(*arguments); }; });
}

}  // namespace disparityd::tools
