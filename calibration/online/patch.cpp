// SPDX-License-Identifier: Apache-2.0
#include "calibration/online/patch.h"

#include <array>

namespace disparityd::calibration {

namespace {

constexpr double least_refined_correlation = 0.85;
constexpr double farthest = 1.5;  // px from the start
constexpr double settled = 1e-3;  // px

using Values = std::array<double, patch_pixels>;

/// Returns Keys' cubic (a = -1/2): the weights of the four pixels around a place that lies `t` after the second.
std::array<double, 4> cubic_weights(double t) {
    return {((-0.5 * t + 1) * t - 0.5) * t, (1.5 * t - 2.5) * t * t + 1, ((-1.5 * t + 2) * t + 0.5) * t,
            (0.5 * t - 0.5) * t * t};
}

/// Interpolates the patch around a place between pixels; false unless it lies in the image with a margin of one pixel.
bool sample(Plane<const std::uint8_t> image, Place centre, Values& values) {
    const int x0 = static_cast<int>(std::floor(centre.x));
    const int y0 = static_cast<int>(std::floor(centre.y));
    if (x0 - patch_radius < 1 || y0 - patch_radius < 1 || x0 + patch_radius + 2 >= image.width ||
        y0 + patch_radius + 2 >= image.height) {
        return false;
    }
    const auto along_x = cubic_weights(centre.x - x0);
    const auto along_y = cubic_weights(centre.y - y0);
    std::array<double, static_cast<std::size_t>(patch_side) * (patch_side + 3)> rows{};
    std::size_t filled = 0;
    for (int y = y0 - patch_radius - 1; y <= y0 + patch_radius + 2; ++y) {
        const std::uint8_t* row = image.row(y) + x0;
        for (int x = -patch_radius; x <= patch_radius; ++x) {
            rows[filled++] =
                along_x[0] * row[x - 1] + along_x[1] * row[x] + along_x[2] * row[x + 1] + along_x[3] * row[x + 2];
        }
    }
    for (std::size_t i = 0; i < values.size(); ++i) {
        values[i] = along_y[0] * rows[i] + along_y[1] * rows[i + patch_side] + along_y[2] * rows[i + 2 * patch_side] +
                    along_y[3] * rows[i + 3 * patch_side];
    }
    return true;
}

/// Normalises to mean 0 and sum of squares 1; false when the patch has no texture.
bool normalise(Values& values) {
    double mean = 0;
    for (const double value : values) {
        mean += value;
    }
    mean /= patch_pixels;
    double squares = 0;
    for (double& value : values) {
        value -= mean;
        squares += value * value;
    }
    if (squares <= 0) {
        return false;
    }
    const double scale = 1 / std::sqrt(squares);
    for (double& value : values) {
        value *= scale;
    }
    return true;
}

/// The left patch, its slopes and the normal matrix of the Gauss-Newton step.
struct Template {
    Values values;
    Values slope_x;
    Values slope_y;
    double xx = 0, xy = 0, yy = 0;

    bool take(Plane<const std::uint8_t> image, Pixel corner) {
        const Place centre{static_cast<double>(corner.x), static_cast<double>(corner.y)};
        Values before;
        Values after;
        constexpr double step = 0.5;
        if (!sample(image, {centre.x - step, centre.y}, before) || !sample(image, {centre.x + step, centre.y}, after) ||
            !sample(image, centre, values)) {
            return false;
        }
        double scale = 0;
        for (std::size_t i = 0; i < values.size(); ++i) {
            slope_x[i] = after[i] - before[i];
        }
        if (!sample(image, {centre.x, centre.y - step}, before) || !sample(image, {centre.x, centre.y + step}, after)) {
            return false;
        }
        Values plain = values;
        if (!normalise(values)) {
            return false;
        }
        // Scale the slopes as the values were.
        for (std::size_t i = 0; i < values.size(); ++i) {
            scale += values[i] * plain[i];
        }
        for (std::size_t i = 0; i < values.size(); ++i) {
            slope_x[i] /= scale;
            slope_y[i] = (after[i] - before[i]) / scale;
            xx += slope_x[i] * slope_x[i];
            xy += slope_x[i] * slope_y[i];
            yy += slope_y[i] * slope_y[i];
        }
        return xx * yy - xy * xy > 1e-9 * (xx + yy) * (xx + yy);
    }
};

}  // namespace

PatchSums sums_of(Plane<const std::uint8_t> image, Pixel centre) {
    PatchSums sums;
    for (int y = centre.y - patch_radius; y <= centre.y + patch_radius; ++y) {
        for (int x = centre.x - patch_radius; x <= centre.x + patch_radius; ++x) {
            const std::int64_t value = image.at(x, y);
            sums.sum += value;
            sums.squares += value * value;
        }
    }
    return sums;
}

std::optional<Place> refine(Plane<const std::uint8_t> left, Pixel corner, Plane<const std::uint8_t> right,
                            Pixel start) {
    constexpr int most_steps = 20;
    Template wanted;
    if (!wanted.take(left, corner)) {
        return std::nullopt;
    }
    const double determinant = wanted.xx * wanted.yy - wanted.xy * wanted.xy;
    Place place{static_cast<double>(start.x), static_cast<double>(start.y)};
    Values found;
    for (int step = 0; step < most_steps; ++step) {
        if (!sample(right, place, found) || !normalise(found)) {
            return std::nullopt;
        }
        double along_x = 0;
        double along_y = 0;
        double correlation = 0;
        for (std::size_t i = 0; i < found.size(); ++i) {
            const double difference = wanted.values[i] - found[i];
            along_x += wanted.slope_x[i] * difference;
            along_y += wanted.slope_y[i] * difference;
            correlation += wanted.values[i] * found[i];
        }
        const double dx = (wanted.yy * along_x - wanted.xy * along_y) / determinant;
        const double dy = (wanted.xx * along_y - wanted.xy * along_x) / determinant;
        place.x += dx;
        place.y += dy;
        if (!(std::abs(place.x - start.x) < farthest && std::abs(place.y - start.y) < farthest)) {
            return std::nullopt;
        }
        if (std::abs(dx) < settled && std::abs(dy) < settled) {
            return correlation >= least_refined_correlation ? std::optional(place) : std::nullopt;
        }
    }
    return std::nullopt;
}

}  // namespace disparityd::calibration
