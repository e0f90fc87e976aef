// SPDX-License-Identifier: Apache-2.0
#include "obstacles/ground_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace disparityd::scan {
namespace {

/// The grid of pixels that are looked at has at least so many rows and columns where the image has, and less than twice
/// as many.
constexpr int grid_rows = 96;
constexpr int grid_columns = 64;
/// So many of its points, and less than twice as many, judge a random plane.
constexpr std::size_t sample_size = 512;
constexpr int tries = 48;
/// A ground has at least so many pixels of the grid, and this part of those that may show it.
constexpr int least_inliers = 80;
constexpr double least_share = 0.25;

/// Numerical Recipes' generator: its high bits are random enough to pick points with.
class Random {
public:
    std::size_t below(std::size_t limit) {
        state_ = state_ * 1664525U + 1013904223U;
        return static_cast<std::size_t>((std::uint64_t{state_} * limit) >> 32);
    }

private:
    std::uint32_t state_ = 1;
};

/// Returns how far the ground may be off from the configured one, mm, `h` mm below the camera.
double largest_step(double h) {
    return std::min(1000 * max_ground_step_m, 0.4 * std::abs(h));
}

using Row = std::array<double, 4>;  ///< three coefficients and the right-hand side

/// Solves three equations; false where they have no single solution.
bool solve(std::array<Row, 3>& m) {
    for (std::size_t i = 0; i < 3; ++i) {
        std::size_t pivot = i;
        for (std::size_t j = i + 1; j < 3; ++j) {
            pivot = std::abs(m[j][i]) > std::abs(m[pivot][i]) ? j : pivot;
        }
        std::swap(m[i], m[pivot]);
        if (!(std::abs(m[i][i]) > 1e-9)) {
            return false;
        }
        for (std::size_t j = 0; j < 3; ++j) {
            if (j != i) {
                const double factor = m[j][i] / m[i][i];
                for (std::size_t k = i; k < 4; ++k) {
                    m[j][k] -= factor * m[i][k];
                }
            }
        }
    }
    for (std::size_t i = 0; i < 3; ++i) {
        m[i][3] /= m[i][i];
    }
    return true;
}

}  // namespace

GroundFit::GroundFit() {
    constexpr std::size_t most = std::size_t{2} * grid_rows * 2 * grid_columns;
    columns_.reserve(std::size_t{2} * grid_columns);
    slack_.reserve(most);
    points_.resize(most);
    sample_.reserve(2 * sample_size);
}

void GroundFit::set(const Geometry& geometry) {
    columns_.clear();
    slack_.clear();
    const Camera& camera = geometry.camera();
    const Rays& rays = geometry.rays();
    step_y_ = std::max(camera.height / grid_rows, 1);
    const int step_x = std::max(camera.width / grid_columns, 1);
    for (int x = step_x / 2; x < camera.width; x += step_x) {
        columns_.push_back({x, rays.up(x, 0), rays.ahead(x, 0), rays.left(x, 0)});
    }
    first_y_ = step_y_ / 2;
    const auto k = static_cast<double>(camera.scale.k);
    for (int y = first_y_; y < camera.height; y += step_y_) {
        // Below a camera that has the ground under it, no ray that rises more than this meets it.
        bool may_show = geometry.options().camera_height_m <= 0;
        for (const Column& column : columns_) {
            const double ahead = rays.ahead(column.x, y);
            const double left = rays.left(column.x, y);
            slack_.push_back(1.5 * max_ground_slope * k * std::sqrt(ahead * ahead + left * left));
            may_show = may_show || k * rays.up(column.x, y) <= slack_.back();
        }
        if (!may_show && y == first_y_) {
            slack_.clear();
            first_y_ += step_y_;
        }
    }
}

void GroundFit::collect(const Pixels& pixels, const Geometry& geometry) {
    std::size_t count = 0;
    Point* const points = points_.data();
    const Camera& camera = geometry.camera();
    const Rays& rays = geometry.rays();
    const auto k = static_cast<double>(camera.scale.k);
    const double h = 1000 * geometry.options().camera_height_m;
    const double step = largest_step(h);
    const double least = geometry.limits().seen * weight_one;
    const double* slack = slack_.data();
    for (int y = first_y_; y < camera.height; y += step_y_) {
        const std::int16_t* disparity = pixels.disparity.row(y);
        const std::uint8_t* confidence = pixels.confidence.row(y);
        const std::uint16_t* weight = geometry.weights(y / group_rows);
        const double up_of_row = rays.up.per_y * y;
        const double ahead_of_row = rays.ahead.per_y * y;
        const double left_of_row = rays.left.per_y * y;
        for (const Column& column : columns_) {
            const double n = disparity[column.x] + camera.scale.offset16;
            const int measured =
                static_cast<int>(confidence[column.x] > 0) & static_cast<int>(n * weight[column.x] >= least);
            const double rise = k * (column.up + up_of_row);
            // n times the height above the configured ground, against n times what slope and step allow there.
            const int near = static_cast<int>(std::abs(h * n + rise) <= step * n + *slack++);
            // Written in any case, counted or not: branches would be guessed wrongly at every edge.
            points[count] = {static_cast<float>(n), static_cast<float>(-rise),
                             static_cast<float>(k * (column.ahead + ahead_of_row)),
                             static_cast<float>(k * (column.left + left_of_row))};
            count += static_cast<std::size_t>(measured & near);
        }
    }
    point_count_ = count;
    sample_.clear();
    const std::size_t every = std::max<std::size_t>(point_count_ / sample_size, 1);
    for (std::size_t i = every / 2; i < point_count_; i += every) {
        sample_.push_back(points_[i]);
    }
}

/// Returns a score that is more than `best`, or any other that is not.
int GroundFit::score(const Parameters& plane, float tolerance, int best) const {
    const auto p = static_cast<float>(plane.p);
    const auto q = static_cast<float>(plane.q);
    const auto t = static_cast<float>(plane.t);
    constexpr std::size_t part = 64;
    int score = 0;
    for (std::size_t begin = 0; begin < sample_.size(); begin += part) {
        const std::size_t left = sample_.size() - begin;
        // Most planes are far off, which the first points show.
        if (score + 2 * static_cast<int>(left) <= best) {
            break;
        }
        for (const Point& point : std::span(sample_).subspan(begin, std::min(part, left))) {
            const float above = point.n - (point.up * p + point.ahead * q + point.left * t);
            // What is seen below a plane speaks against it.
            score += (std::abs(above) <= tolerance ? 2 : 0) - (above < -2 * tolerance ? 1 : 0);
        }
    }
    return score;
}

std::optional<GroundFit::Parameters> GroundFit::through(std::size_t a, std::size_t b, std::size_t c) const {
    std::array<Row, 3> m{};
    std::size_t i = 0;
    for (const std::size_t index : {a, b, c}) {
        const Point& point = sample_[index];
        m[i++] = {point.up, point.ahead, point.left, point.n};
    }
    if (!solve(m)) {
        return std::nullopt;
    }
    return Parameters{m[0][3], m[1][3], m[2][3]};
}

/// Returns the plane through those of the points that lie on `plane`, by least squares.
std::optional<GroundFit::Parameters> GroundFit::least_squares(std::span<const Point> points, const Parameters& plane,
                                                              float tolerance, int& inliers) {
    std::array<Row, 3> m{};
    inliers = 0;
    for (const Point& point : points) {
        const std::array<double, 4> row{point.up, point.ahead, point.left, point.n};
        const double above = row[3] - (row[0] * plane.p + row[1] * plane.q + row[2] * plane.t);
        if (std::abs(above) > tolerance) {
            continue;
        }
        ++inliers;
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t j = i; j < 4; ++j) {
                m[i][j] += row[i] * row[j];
            }
        }
    }
    m[1][0] = m[0][1];
    m[2][0] = m[0][2];
    m[2][1] = m[1][2];
    if (!solve(m)) {
        return std::nullopt;
    }
    return Parameters{m[0][3], m[1][3], m[2][3]};
}

bool GroundFit::allowed(const Parameters& plane, double h) const {
    if (!(plane.p > 0)) {
        return false;
    }
    const double height = h - 1 / plane.p;
    return std::abs(height) <= largest_step(h) && std::abs(plane.q / plane.p) <= max_ground_slope &&
           std::abs(plane.t / plane.p) <= max_ground_slope;
}

std::optional<GroundPlane> GroundFit::fit(const Pixels& pixels, const Geometry& geometry, const GroundPlane& near) {
    collect(pixels, geometry);
    if (point_count_ < least_inliers) {
        return std::nullopt;
    }
    const double h = 1000 * geometry.options().camera_height_m;
    const auto tolerance = static_cast<float>(std::max(8.0, 2.5 * 16 * geometry.options().subpixel_error_px));
    const double p = 1 / (h - 1000 * near.height_m);
    Parameters best{p, p * near.slope_ahead, p * near.slope_left};
    int best_score = score(best, tolerance, std::numeric_limits<int>::min());
    Random random;
    for (int i = 0; i < tries; ++i) {
        const std::size_t a = random.below(sample_.size());
        const std::size_t b = random.below(sample_.size());
        const std::size_t c = random.below(sample_.size());
        const auto plane = through(a, b, c);
        if (!plane || !allowed(*plane, h)) {
            continue;
        }
        const int found = score(*plane, tolerance, best_score);
        if (found > best_score) {
            best_score = found;
            best = *plane;
        }
    }
    int inliers = 0;
    const std::span<const Point> all{points_.data(), point_count_};
    for (const std::span<const Point> points :
         {std::span<const Point>(sample_), std::span<const Point>(sample_), all}) {
        const auto better = least_squares(points, best, tolerance, inliers);
        if (!better || !allowed(*better, h)) {
            return std::nullopt;
        }
        best = *better;
    }
    if (inliers < least_inliers || inliers < least_share * static_cast<double>(point_count_)) {
        return std::nullopt;
    }
    return GroundPlane{(h - 1 / best.p) / 1000, best.q / best.p, best.t / best.p};
}

}  // namespace disparityd::scan
