// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/scan/surface_luma.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace disparityd::eval {
namespace {

std::uint32_t hash(std::int64_t x, std::int64_t y, std::int64_t z, std::uint32_t seed) {
    std::uint64_t h = static_cast<std::uint64_t>(x) * 0x9e3779b97f4a7c15ULL ^
                      static_cast<std::uint64_t>(y) * 0xc2b2ae3d27d4eb4fULL ^
                      static_cast<std::uint64_t>(z) * 0x165667b19e3779f9ULL ^ seed;
    h = (h ^ (h >> 29)) * 0xbf58476d1ce4e5b9ULL;
    return static_cast<std::uint32_t>(h >> 32);
}

/// The random values at the corners of a cell.
struct Corners {
    std::array<std::int64_t, 3> cell{};
    std::uint32_t seed = 0;
    bool known = false;
    std::array<double, 8> values{};
};

/// Neighbouring pixels mostly lie in the same cell: hashes are most of what drawing a course costs.
const std::array<double, 8>& values_at(const std::array<std::int64_t, 3>& cell, std::uint32_t seed, int octave) {
    thread_local std::array<Corners, 16> newest;
    Corners& corners = newest[static_cast<std::size_t>(octave) % newest.size()];
    if (!corners.known || corners.cell != cell || corners.seed != seed) {
        corners = {cell, seed, true, {}};
        for (int corner = 0; corner < 8; ++corner) {
            const std::uint32_t random =
                hash(cell[0] + (corner & 1), cell[1] + ((corner >> 1) & 1), cell[2] + (corner >> 2), seed);
            corners.values[static_cast<std::size_t>(corner)] = random / 2147483648.0 - 1;
        }
    }
    return corners.values;
}

/// Smooth noise of one grain size, -1 .. 1. `octave` tells the sizes of one surface apart.
double noise(Point p, double grain, std::uint32_t seed, int octave) {
    const std::array<double, 3> at{p.x / grain, p.y / grain, p.z / grain};
    std::array<std::int64_t, 3> cell{};
    std::array<double, 3> part{};
    for (std::size_t i = 0; i < 3; ++i) {
        cell[i] = static_cast<std::int64_t>(std::floor(at[i]));
        const double t = at[i] - static_cast<double>(cell[i]);
        part[i] = t * t * (3 - 2 * t);
    }
    const std::array<double, 8>& values = values_at(cell, seed, octave);
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const int dx = corner & 1;
        const int dy = (corner >> 1) & 1;
        const int dz = corner >> 2;
        const double weight =
            (dx != 0 ? part[0] : 1 - part[0]) * (dy != 0 ? part[1] : 1 - part[1]) * (dz != 0 ? part[2] : 1 - part[2]);
        sum += weight * values[static_cast<std::size_t>(corner)];
    }
    return sum;
}

/// Structure of several sizes, about -1 .. 1.
double rough(const Surface& surface, Point p, double pixel_m, std::uint32_t seed) {
    double value = 0;
    double weight = 0.6;
    int octave = 0;
    for (double grain = surface.grain_m * 4; grain > std::max(pixel_m, 0.002); grain /= 2, weight *= 0.8) {
        value += weight * noise(p, grain, seed, octave++);
    }
    return value;
}

double chequered(Point p, double side) {
    const auto cell = [side](double at) { return static_cast<int>(std::floor(at / side + 0.25)); };
    return ((cell(p.y) + cell(p.z)) & 1) != 0 ? 0.8 : -0.8;
}

/// Dark joints between tiles.
double tiled(Point p, double side) {
    constexpr double joint = 0.06;
    const auto in_joint = [side](double at) { return at / side - std::floor(at / side) < joint; };
    return in_joint(p.x) || in_joint(p.y) ? -1.4 : 0.1;
}

/// What a surface's kind looks like, about -1 .. 1; a mirror and glass have no look of their own.
double regular(const Surface& surface, Point p, double pixel_m) {
    const double turn = 2 * std::numbers::pi / surface.grain_m;
    const double fading = std::min(1.0, surface.grain_m / (2 * pixel_m));
    switch (surface.kind) {
        case Surface::Kind::striped: return std::sin(turn * (p.y + 0.37 * p.x));
        case Surface::Kind::blinds: return fading * std::sin(turn * p.z);
        case Surface::Kind::chequered: return fading * chequered(p, surface.grain_m);
        case Surface::Kind::tiled: return fading * tiled(p, surface.grain_m);
        case Surface::Kind::rough:
        case Surface::Kind::plain:
        case Surface::Kind::mirror:
        case Surface::Kind::glass: break;
    }
    return 0;
}

}  // namespace

double luma(const Surface& surface, Point p, double pixel_m, std::uint32_t seed) {
    if (surface.kind == Surface::Kind::rough || surface.kind == Surface::Kind::mirror ||
        surface.kind == Surface::Kind::glass) {
        return surface.luma + surface.contrast * rough(surface, p, pixel_m, seed);
    }
    double value = surface.share * regular(surface, p, pixel_m);
    if (surface.share < 1) {
        value += (1 - surface.share) * rough(surface, p, pixel_m, seed);
    }
    return surface.luma + surface.contrast * value;
}

}  // namespace disparityd::eval
