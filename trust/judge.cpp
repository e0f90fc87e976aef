// SPDX-License-Identifier: Apache-2.0
#include "trust/judge.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <numeric>
#include <utility>

#include "kernels/near_plane.h"
#include "proto/doubt.h"

namespace disparityd::trust {
namespace {

constexpr std::int64_t window_ns = 1'000'000'000;
constexpr int least_frames = 10;
constexpr int most_frames = 200;  // where the times of a source do not grow

constexpr int white_level = 250;
constexpr std::int64_t least_eye_texture = 120;  // mean of an eye
constexpr int covered_factor = 36;

constexpr std::int64_t least_fine_texture = 12;  // mean square over an eye, beyond the noise
constexpr int windows_of_dirt = 3;

/// Returns the cell, of so many, in which a pixel lies.
int cell_of(int pixel, int size, int cells) {
    int cell = pixel * cells / size;
    while (cell_begin(cell + 1, size, cells) <= pixel) {
        ++cell;
    }
    return cell;
}

/// Returns how many of the reduced image's pixels are darker than `level`.
std::int64_t darker(const EyeTexture& eye, int level) {
    return std::accumulate(eye.levels.begin(), eye.levels.begin() + level, std::int64_t{0});
}

bool is_dark(const EyeTexture& eye, int level) {
    return 10 * darker(eye, level) > 9 * eye.reduced_pixels;
}

bool is_saturated(const EyeTexture& eye) {
    return 4 * (eye.reduced_pixels - darker(eye, white_level)) > eye.reduced_pixels;
}

std::int64_t mean_texture(const EyeTexture& eye) {
    return std::accumulate(eye.coarse.begin(), eye.coarse.end(), std::int64_t{0}) / cell_count;
}

/// Returns whether one eye shows hardly any texture where the other has some.
bool one_is_covered(const EyeTexture& one, const EyeTexture& other) {
    const auto [less, more] = std::minmax({mean_texture(one), mean_texture(other)});
    return more >= least_eye_texture && less * covered_factor < more;
}

std::int64_t sum_beyond(const Cells<std::int64_t>& values, std::int64_t noise) {
    return std::accumulate(
        values.begin(), values.end(), std::int64_t{0},
        [noise](std::int64_t sum, std::int64_t value) { return sum + std::max<std::int64_t>(value - noise, 0); });
}

/// Marks the cells that are dull since some windows together with a neighbour. Returns whether there are any.
bool find_dirt(const Cells<int>& dull_windows, Cells<bool>& dirt) {
    const auto dull = [&](int row, int column) {
        return row >= 0 && row < cell_rows && column >= 0 && column < cell_columns &&
               dull_windows[static_cast<std::size_t>(row * cell_columns + column)] >= windows_of_dirt;
    };
    bool any = false;
    for (int row = 0; row < cell_rows; ++row) {
        for (int column = 0; column < cell_columns; ++column) {
            const bool dirty = dull(row, column) && (dull(row, column - 1) || dull(row, column + 1) ||
                                                     dull(row - 1, column) || dull(row + 1, column));
            dirt[static_cast<std::size_t>(row * cell_columns + column)] = dirty;
            any = any || dirty;
        }
    }
    return any;
}

/// Returns the share of the pixels that are measured, in 255ths, as every eighth of every eighth row tells.
int measured_share(Plane<const std::uint8_t> confidence) {
    constexpr int step = 8;
    int measured = 0;
    int all = 0;
    for (int y = step / 2; y < confidence.height; y += step) {
        for (int x = step / 2; x < confidence.width; x += step) {
            measured += confidence.at(x, y) != 0 ? 1 : 0;
            ++all;
        }
    }
    return 255 * measured / all;
}

/// Returns whether a twentieth of the image is nearer than the range: so many blocks, where the scan has told which are
/// no ground, else all that the near guard has found.
bool is_too_near(Plane<const std::int16_t> near, std::optional<std::ptrdiff_t> blocks) {
    return near && 20 * blocks.value_or(near_count(near)) >= std::ptrdiff_t{near.width} * near.height;
}

}  // namespace

void Judge::Held::note(bool found) {
    found_ = found ? found_ + 1 : 0;
    missed_ = found ? 0 : missed_ + 1;
    holds_ = found_ >= until_held_ || (holds_ && missed_ < until_over_);
}

Judge::Judge(int width, int height, const TrustOptions& options, Plane<const std::uint8_t> masked)
    : options_(options),
      rows_limit_(static_cast<int>(std::lround(options.rows_px * RowOffsets::unit))),
      judged_(EyeMeter::fits(width, height)),
      meters_{EyeMeter(width, height), EyeMeter(width, height)} {
    if (judged_ && masked) {
        set_masked_cells(masked);
    }
}

/// A part of the robot is farther left in the right eye, by a disparity that is not known.
void Judge::set_masked_cells(Plane<const std::uint8_t> masked) {
    for (int y = 0; y < masked.height; ++y) {
        for (int x = 0; x < masked.width; ++x) {
            if (masked.at(x, y) == 0) {
                continue;
            }
            const int row = cell_of(y, masked.height, cell_rows);
            const int column = cell_of(x, masked.width, cell_columns);
            bool* const left_row = &masked_[left][static_cast<std::size_t>(row * cell_columns)];
            bool* const right_row = &masked_[right][static_cast<std::size_t>(row * cell_columns)];
            left_row[column] = true;
            std::fill(right_row, right_row + column + 1, true);
        }
    }
}

Verdict Judge::judge(const FrameView& frame, std::int64_t time_ns, bool anew,
                     std::optional<std::ptrdiff_t> near_blocks) {
    if (!judged_) {
        return {};
    }
    if (anew) {
        findings_ = {};
    }
    if (anew || window_.frames == 0 || time_ns < window_.began_ns) {
        window_ = {};
        window_.began_ns = time_ns;
    }
    meters_[left].measure(frame.left, eyes_[left]);
    meters_[right].measure(frame.right, eyes_[right]);
    const bool covered = one_is_covered(eyes_[left], eyes_[right]);
    findings_.covered.note(covered);
    ++window_.frames;
    if (!covered) {
        add_to_window(frame);
    }
    if ((time_ns - window_.began_ns >= window_ns && window_.frames >= least_frames) || window_.frames >= most_frames) {
        close_window(frame);
        window_ = {};
        window_.began_ns = time_ns;
    }
    const std::uint32_t found = doubts(frame, near_blocks);
    return {found, proto::trust_in(measured_share(frame.confidence), found)};
}

std::uint32_t Judge::doubts(const FrameView& frame, std::optional<std::ptrdiff_t> near_blocks) const {
    const EyeTexture& one = eyes_[left];
    const EyeTexture& other = eyes_[right];
    std::uint32_t found = 0;
    const auto add = [&found](proto::Doubt doubt, bool holds) { found |= holds ? doubt : 0U; };
    add(proto::doubt_dark, is_dark(one, options_.dark_level) && is_dark(other, options_.dark_level));
    add(proto::doubt_saturated, is_saturated(one) || is_saturated(other));
    add(proto::doubt_covered_eye, findings_.covered.holds());
    add(proto::doubt_blurred, findings_.blurred.holds());
    add(proto::doubt_dirty_eye, findings_.dirty.holds());
    add(proto::doubt_misaligned, findings_.misaligned.holds());
    add(proto::doubt_too_near, is_too_near(frame.near, near_blocks));
    add(proto::doubt_noisy, frame.noise_level > 0);
    return found;
}

void Judge::add_to_window(const FrameView& frame) {
    find_dull_cells(frame, eyes_[left], eyes_[right], cells_);
    for (const EyeIndex eye : {left, right}) {
        const Cells<CellState>& states = eye == left ? cells_.left : cells_.right;
        for (std::size_t i = 0; i < states.size(); ++i) {
            const CellState state = masked_[eye][i] ? CellState::unknown : states[i];
            window_.judged[eye][i] += state != CellState::unknown ? 1 : 0;
            window_.dull[eye][i] += state == CellState::dull ? 1 : 0;
            window_.fine[eye][i] += eyes_[eye].fine[i];
        }
    }
    window_.rows.add(frame, turn_++);
}

void Judge::close_window(const FrameView& frame) {
    const bool blurred = find_blurred();
    const bool dirty = find_dirty();
    findings_.blurred.note(blurred);
    findings_.dirty.note(dirty && !blurred);
    findings_.misaligned.note(find_misaligned());
    if (dirty && !blurred) {
        find_dirty_cells(frame);
    } else if (!findings_.dirty.holds()) {
        findings_.dirty_cells.fill(false);
        findings_.mapped_cells.fill(false);
    }
}

/// Noise is no texture: what the dullest cells of either eye have is taken off both.
bool Judge::find_blurred() const {
    const std::int64_t noise = std::min(low_value(window_.fine[left]), low_value(window_.fine[right]));
    const auto [less, more] =
        std::minmax({sum_beyond(window_.fine[left], noise), sum_beyond(window_.fine[right], noise)});
    return more >= least_fine_texture * cell_count * window_.frames && 10 * less < 4 * more;
}

/// Counts for each cell the windows in a row in which it was dull most of the time.
bool Judge::find_dirty() {
    for (const EyeIndex eye : {left, right}) {
        for (std::size_t i = 0; i < static_cast<std::size_t>(cell_count); ++i) {
            const int judged = window_.judged[eye][i];
            const bool dull = 2 * judged >= window_.frames && 5 * window_.dull[eye][i] >= 4 * judged;
            int& windows = findings_.dull_windows[eye][i];
            windows = dull ? windows + 1 : 0;
        }
    }
    const bool of_left = find_dirt(findings_.dull_windows[left], dirt_[left]);
    const bool of_right = find_dirt(findings_.dull_windows[right], dirt_[right]);
    return of_left || of_right;
}

/// Dirt of the right eye shows where the disparities put it. Where those of a row put none of it anywhere, it is still
/// there: the cells of the row stay as they were.
void Judge::find_dirty_cells(const FrameView& frame) {
    Cells<bool> mapped{};
    add_left_cells(frame, dirt_[right], mapped);
    findings_.dirty_cells = dirt_[left];
    for (int row = 0; row < cell_rows; ++row) {
        const auto begin = static_cast<std::ptrdiff_t>(row) * cell_columns;
        const auto any = [begin](const Cells<bool>& cells) {
            const auto first = cells.begin() + begin;
            return std::find(first, first + cell_columns, true) != first + cell_columns;
        };
        const bool kept = !any(mapped) && any(dirt_[right]);
        for (std::ptrdiff_t i = begin; i < begin + cell_columns; ++i) {
            const auto cell = static_cast<std::size_t>(i);
            findings_.mapped_cells[cell] = kept ? findings_.mapped_cells[cell] : mapped[cell];
            findings_.dirty_cells[cell] = findings_.dirty_cells[cell] || findings_.mapped_cells[cell];
        }
    }
}

/// A turned eye, or one of another focal length, fits in some bands.
bool Judge::find_misaligned() const {
    bool off = false;
    for (int band = 0; band < RowOffsets::bands; ++band) {
        off = off || std::abs(window_.rows.median(band).value_or(0)) >= rows_limit_;
    }
    return off;
}

}  // namespace disparityd::trust
