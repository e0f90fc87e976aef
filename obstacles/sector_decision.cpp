// SPDX-License-Identifier: Apache-2.0
#include "obstacles/sector_decision.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace disparityd::scan {
namespace {

/// Pixels that agree on a distance lie in so many bins: 1 px, or an eighth of the disparity.
constexpr int window = 4;
/// An obstacle shows itself by this part of the pixels that the smallest one has, in 256ths, and by so many at least.
constexpr std::uint32_t support_share = 77;
constexpr int all_shares = 256;
constexpr std::uint32_t least_support = 8;
/// It has this part of all obstacle pixels there: fewer are the near end of the spread of a surface.
constexpr std::uint32_t least_part = 16;
/// A group of rows of a sector is seen when this part of it was measured.
constexpr std::uint32_t seen_numerator = 2;
constexpr std::uint32_t seen_denominator = 3;

/// The pixels that an obstacle needs where the smallest one has this side, in 1/16 px, seen on so many columns.
std::uint32_t support(std::uint32_t side, std::uint32_t columns) {
    const std::uint32_t wide = std::min(side, 16 * columns);
    return std::max(static_cast<std::uint32_t>((std::uint64_t{wide} * side * support_share) >> 16), least_support);
}

/// The heights of the band from the camera on, and the side of the smallest obstacle in it, in mm.
struct HidingRoom {
    double above;
    double below;
    double side;
};

/// No obstacle hides at any distance.
constexpr double nowhere = 1e9;

/// Returns the least distance in mm, at least `least`, at which an obstacle can hide in rows that fall from `top` to
/// `bottom` per horizontal mm. They show, at distance r, the heights r top to r bottom below the camera; an obstacle
/// hides when as much of that is in the band as its side.
double hiding_distance(double top, double bottom, const HidingRoom& room, double least) {
    double from = std::max(least, bottom > top ? room.side / (bottom - top) : nowhere);
    double to = nowhere;
    const auto limit = [&](double per_mm, double most) {  // per_mm r <= most
        if (per_mm > 0) {
            to = std::min(to, most / per_mm);
        } else if (per_mm < 0) {
            from = std::max(from, most / per_mm);
        } else if (most < 0) {
            to = 0;
        }
    };
    limit(-bottom, room.above - room.side);
    limit(top, room.below - room.side);
    return from <= to ? from : nowhere;
}

template <typename T>
T rounded(double value) {
    using Limits = std::numeric_limits<T>;
    return static_cast<T>(std::floor(std::clamp(value, double{Limits::min()}, double{Limits::max()}) + 0.5));
}

}  // namespace

SectorDecision::SectorDecision(const Geometry& geometry)
    : windows_(index(geometry.sectors()) * bins),
      all_(index(geometry.sectors())),
      tops_(index(geometry.sectors())),
      object_side_(bins),
      columns_(index(geometry.sectors())),
      resolved_(index(geometry.sectors())),
      area_(index(geometry.sectors()) * index(geometry.groups())),
      masked_(area_.size()),
      all_masked_(index(geometry.sectors())),
      found_(index(geometry.sectors())) {}

void SectorDecision::set(const Geometry& geometry, const ImageMask& mask) {
    if (!geometry.camera().metric()) {
        return;
    }
    // At k / m mm a side of s mm has f s m / k pixels; f B = k / 16.
    const auto k = static_cast<double>(geometry.camera().scale.k);
    const double side_mm = 1000 * geometry.options().object_m;
    for (int b = 0; b < bins; ++b) {
        const double pixels = geometry.camera().f * side_mm * bin_begin(std::min(b, used_bins)) / k;
        object_side_[index(b)] = static_cast<std::uint32_t>(std::min(16 * pixels, 1e6));
    }
    set_area(geometry, mask);
    for (int s = 0; s < geometry.sectors(); ++s) {
        // The farthest bin in which the share, and not the least number, is what an obstacle needs.
        int b = 0;
        while (b < used_bins &&
               support(object_side_[index(b)], static_cast<std::uint32_t>(columns_[index(s)])) <= least_support) {
            ++b;
        }
        resolved_[index(s)] = k / std::max(bin_begin(b), 1);
    }
}

/// Counts the pixels of each sector, and those of them that are masked.
void SectorDecision::set_area(const Geometry& geometry, const ImageMask& mask) {
    for (int s = 0; s < geometry.sectors(); ++s) {
        int least = std::numeric_limits<int>::max();
        std::uint32_t all = 0;
        std::uint32_t all_masked = 0;
        for (int group = 0; group < geometry.groups(); ++group) {
            const std::int16_t* edges = geometry.edges(group);
            const int columns = edges[s] - edges[s + 1];
            const int end = group_end(group, geometry.camera().height);
            std::uint32_t masked = 0;
            for (int y = group * group_rows; y < end && !mask.empty(); ++y) {
                for (int x = edges[s + 1]; x < edges[s]; ++x) {
                    masked += mask.at(x, y) ? 1U : 0U;
                }
            }
            const std::size_t place = index(s * geometry.groups() + group);
            area_[place] = static_cast<std::uint32_t>(columns * (end - group * group_rows));
            masked_[place] = masked;
            all += area_[place];
            all_masked += masked;
            least = columns > 0 ? std::min(least, columns) : least;
        }
        columns_[index(s)] = least == std::numeric_limits<int>::max() ? 0 : least;
        all_masked_[index(s)] = all > 0 && all == all_masked;
    }
}

void SectorDecision::sum_windows(const Counts& counts) {
    for (int s = 0; s < counts.sectors; ++s) {
        const std::uint32_t* count = counts.obstacle_of(s);
        std::uint32_t* sum = &windows_[index(s) * bins];
        all_[index(s)] = std::accumulate(count, count + used_bins, std::uint32_t{0});
        for (int b = 0; b < window - 1; ++b) {
            sum[b] = 0;
            for (int i = 0; i <= b; ++i) {
                sum[b] += count[i];
            }
        }
        for (int b = window - 1; b < used_bins; ++b) {
            sum[b] = count[b] + count[b - 1] + count[b - 2] + count[b - 3];
        }
        int top = used_bins - 1;
        while (top >= 0 && sum[top] == 0) {
            --top;
        }
        tops_[index(s)] = top;
    }
}

/// Returns the nearest bin, from `top` on, at which one sector, or two together, have the support for an obstacle; -1:
/// none.
int SectorDecision::nearest(const std::uint32_t* one, const std::uint32_t* other, int top, int columns,
                            std::uint32_t all) const {
    const std::uint32_t least = std::max(least_support, all / least_part);
    for (int b = top; b >= 0; --b) {
        const std::uint32_t pixels = one[b] + (other == nullptr ? 0 : other[b]);
        if (pixels >= least && pixels >= support(object_side_[index(b)], static_cast<std::uint32_t>(columns))) {
            return b;
        }
    }
    return -1;
}

void SectorDecision::find_obstacles(const Geometry& geometry) {
    const int sectors = geometry.sectors();
    for (int s = 0; s < sectors; ++s) {
        found_[index(s)].last =
            nearest(&windows_[index(s) * bins], nullptr, tops_[index(s)], columns_[index(s)], all_[index(s)]);
    }
    // What stands on the edge of two sectors may have too few pixels in each.
    for (int s = 0; s + 1 < sectors; ++s) {
        const std::uint32_t* right = &windows_[index(s) * bins];
        const std::uint32_t* left = &windows_[index(s + 1) * bins];
        const int b = nearest(right, left, std::max(tops_[index(s)], tops_[index(s + 1)]),
                              columns_[index(s)] + columns_[index(s + 1)], all_[index(s)] + all_[index(s + 1)]);
        if (b < 0) {
            continue;
        }
        const std::uint32_t part = (right[b] + left[b]) / 4;
        if (right[b] >= part) {
            found_[index(s)].last = std::max(found_[index(s)].last, b);
        }
        if (left[b] >= part) {
            found_[index(s + 1)].last = std::max(found_[index(s + 1)].last, b);
        }
    }
    // The first window with enough pixels holds the near end of the obstacle only: its middle is where most are.
    for (int s = 0; s < sectors; ++s) {
        Found& found = found_[index(s)];
        const std::uint32_t* sum = &windows_[index(s) * bins];
        for (int b = found.last - 1, end = std::max(found.last - window, 0); b >= end; --b) {
            found.last = sum[b] > sum[found.last] ? b : found.last;
        }
        found.first = std::max(found.last - window + 1, 0);
    }
}

/// Returns the distance in mm up to which no obstacle of the smallest size can hide where nothing was measured.
double SectorDecision::free_distance(const Geometry& geometry, const GroundPlane& ground, const Counts& counts,
                                     int sector) const {
    const ScanOptions& options = geometry.options();
    const double h = 1000 * (options.camera_height_m - ground.height_m);
    HidingRoom room{1000 * options.high_m - h, h - 1000 * options.low_m, 1000 * options.object_m};
    room.side = std::min(room.side, room.above + room.below);
    const double slope =
        ground.slope_ahead * geometry.bearing_cos(sector) + ground.slope_left * geometry.bearing_sin(sector);
    const double least = 1000 * options.min_m;
    double free = std::min({1000 * options.max_m, resolved_[index(sector)],
                            static_cast<double>(geometry.camera().scale.k) / geometry.limits().sure});
    // The rest of what a mask hides may show too little to be found.
    HidingRoom behind_mask = room;
    behind_mask.side *= double{all_shares - support_share} / all_shares;
    bool any = false;
    bool masked = false;
    int begin = -1;
    for (int group = 0; group <= geometry.groups(); ++group) {
        const std::size_t place = index(sector * geometry.groups() + group);
        const std::uint32_t area = group < geometry.groups() ? area_[place] : 0;
        any = any || area > 0;
        const bool touches_mask = area > 0 && masked_[place] > 0;
        if (touches_mask || (area > 0 && counts.seen_of(sector, group) * seen_denominator < area * seen_numerator)) {
            begin = begin < 0 ? group : begin;
            masked = masked || touches_mask;
            continue;
        }
        if (begin >= 0) {
            free = std::min(free,
                            hiding_distance(slope - geometry.rise(sector, begin), slope - geometry.rise(sector, group),
                                            masked ? behind_mask : room, least));
            begin = -1;
            masked = false;
        }
    }
    return any ? free : 0;
}

/// Fills in the distance of an obstacle and its error.
void SectorDecision::describe(const Geometry& geometry, const Counts& counts, int sector, ScanSector& out) const {
    const Found& found = found_[index(sector)];
    const std::uint32_t* count = counts.obstacle_of(sector);
    double sum = 0;
    std::uint32_t pixels = 0;
    for (int b = found.first; b <= found.last; ++b) {
        pixels += count[b];
        sum += count[b] * ((bin_begin(b) + bin_begin(b + 1) - 1) / 2.0);
    }
    const double m = std::max(sum / pixels, 1.0);
    const auto k = static_cast<double>(geometry.camera().scale.k);
    out.state = SectorState::occupied;
    out.pixels = rounded<std::uint16_t>(pixels);
    // Bins at the limits reach a little beyond them; the pixels do not.
    const ScanOptions& options = geometry.options();
    out.distance_mm = rounded<std::uint16_t>(std::clamp(k / m, 1000 * options.min_m, 1000 * options.max_m));
    out.sigma_mm = rounded<std::uint16_t>(k * 16 * geometry.options().subpixel_error_px / (m * m));
}

/// Fills in heights and confidence of an obstacle, from the middle row of each group.
void SectorDecision::add_extent(const Pixels& pixels, const Geometry& geometry, const GroundPlane& ground,
                                const Counts& counts, int sector, ScanSector& out) const {
    const Found& found = found_[index(sector)];
    const auto first = static_cast<std::uint8_t>(found.first);
    const auto span = static_cast<std::uint8_t>(found.last - found.first);
    const int offset = geometry.camera().scale.offset16;
    const auto k = static_cast<double>(geometry.camera().scale.k);
    const double h = 1000 * (geometry.options().camera_height_m - ground.height_m);
    const Linear rise = rise_above(geometry.rays(), ground);
    double low = 1e9;
    double high = -1e9;
    int confidence = 0;
    int seen = 0;
    for (int group = 0; group < geometry.groups(); ++group) {
        if (counts.middle_counted[index(group)] == 0) {
            continue;
        }
        const int y = group_middle(group, geometry.camera().height);
        const std::int16_t* edges = geometry.edges(group);
        const std::uint8_t* bin = counts.middle_bins_of(group);
        const std::int16_t* disparity = pixels.disparity.row(y);
        const std::uint8_t* sureness = pixels.confidence.row(y);
        int sum_of_n = 0;
        int count = 0;
        for (int x = edges[sector + 1]; x < edges[sector]; ++x) {
            // Without branches, which would be guessed wrongly at every edge.
            const int in = static_cast<std::uint8_t>(bin[x] - first) <= span ? -1 : 0;
            sum_of_n += in & (disparity[x] + offset);
            confidence += in & sureness[x];
            count -= in;
        }
        if (count > 0) {
            const double x = (edges[sector + 1] + edges[sector] - 1) / 2.0;
            const double height = h + k * rise(x, y) * count / sum_of_n;
            low = std::min(low, height);
            high = std::max(high, height);
            seen += count;
        }
    }
    if (seen > 0) {
        out.low_mm = rounded<std::int16_t>(low);
        out.high_mm = rounded<std::int16_t>(high);
        out.confidence = static_cast<std::uint8_t>(confidence / seen);
    }
}

void SectorDecision::decide(const Pixels& pixels, const Geometry& geometry, const GroundPlane& ground,
                            const Counts& counts, std::span<ScanSector> sectors) {
    sum_windows(counts);
    find_obstacles(geometry);
    for (int s = 0; s < geometry.sectors(); ++s) {
        ScanSector& out = sectors[index(s)];
        out = {};
        out.from_cdeg = rounded<std::int16_t>(100 * geometry.edge_deg(s));
        out.to_cdeg = rounded<std::int16_t>(100 * geometry.edge_deg(s + 1));
        const double free = free_distance(geometry, ground, counts, s);
        if (found_[index(s)].last >= 0) {
            describe(geometry, counts, s, out);
            add_extent(pixels, geometry, ground, counts, s, out);
            out.free_mm = std::min(rounded<std::uint16_t>(free), out.distance_mm);
        } else if (all_masked_[index(s)]) {
            out.state = SectorState::masked;
        } else {
            out.free_mm = rounded<std::uint16_t>(free);
            out.state = free > 1000 * geometry.options().min_m ? SectorState::free : SectorState::unknown;
        }
    }
}

}  // namespace disparityd::scan
