// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/scan/radar.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string_view>

#include "base/number_text.h"

namespace disparityd::tools {
namespace {

constexpr double radians = std::numbers::pi / 180;
constexpr int label_columns = 7;  ///< room for the longest label, right of the outermost ring

/// The block characters by their quarters: 1 upper left, 2 upper right, 4 lower left, 8 lower right.
constexpr std::array<std::string_view, 16> quarters{" ", "▘", "▝", "▀", "▖", "▌", "▞", "▛",
                                                    "▗", "▚", "▐", "▜", "▄", "▙", "▟", "█"};

struct RadarGlyphs {
    const char* free;
    const char* ring;
    const char* robot;
};
constexpr RadarGlyphs ascii_glyphs{".", "+", "^"};
constexpr RadarGlyphs block_glyphs{"░", "·", "▲"};

/// How far the drawn circle sectors reach from the robot, in metres.
struct RadarExtent {
    double ahead = 0;
    double behind = 0;
    double left = 0;
    double right = 0;

    void add(double bearing_deg, double range_m) {
        const double x = range_m * std::cos(bearing_deg * radians);
        const double y = range_m * std::sin(bearing_deg * radians);
        ahead = std::max(ahead, x);
        behind = std::max(behind, -x);
        left = std::max(left, y);
        right = std::max(right, -y);
    }
};

RadarExtent extent_of(const std::vector<disparity::ScanSector>& sectors, double range_m) {
    RadarExtent extent;
    extent.add(0, sectors.empty() ? range_m : 0);
    for (const disparity::ScanSector& sector : sectors) {
        extent.add(sector.from_deg, range_m);
        extent.add(sector.to_deg, range_m);
        for (const double axis : {-90.0, 0.0, 90.0}) {
            if (sector.from_deg <= axis && axis <= sector.to_deg) {
                extent.add(axis, range_m);
            }
        }
    }
    return extent;
}

/// Returns the least round distance between rings that keeps them apart and few.
double ring_step(double range_m, double metres_per_row) {
    constexpr int most = 5;
    for (const double step : {0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0}) {
        if (step >= 3 * metres_per_row && range_m / step <= most) {
            return step;
        }
    }
    return range_m;
}

/// Draws one plot. Metres become columns and rows; each character has two by two quarters.
class RadarDrawing {
public:
    RadarDrawing(const disparity::Scan& scan, const RadarStyle& style)
        : sectors_(scan.sectors),
          range_m_(style.range_m),
          ascii_(style.ascii),
          glyphs_(style.ascii ? ascii_glyphs : block_glyphs) {
        const int columns = std::max(style.columns, 20);
        const int rows = std::max(style.rows, 4);
        const RadarExtent extent = extent_of(sectors_, range_m_);
        scale_ = std::max((extent.left + extent.right) / (columns - label_columns - 1),
                          (extent.ahead + extent.behind) / (2 * (rows - 1)));
        robot_column_ = whole(extent.left / scale_);
        robot_row_ = whole(extent.ahead / (2 * scale_));
        plot_.columns = std::min(columns, robot_column_ + whole(extent.right / scale_) + 1 + label_columns);
        plot_.rows = std::min(rows, robot_row_ + whole(extent.behind / (2 * scale_)) + 1);
        plot_.cells.resize(static_cast<std::size_t>(plot_.columns) * static_cast<std::size_t>(plot_.rows));
    }

    RadarPlot draw() {
        shade_free();
        draw_rings();
        draw_obstacles();
        put(robot_column_, robot_row_, glyphs_.robot, RadarInk::robot);
        return std::move(plot_);
    }

private:
    static int whole(double number) { return static_cast<int>(std::lround(number)); }

    /// The place of a point in characters; whole numbers are the middle of one.
    double column_of(double bearing_deg, double distance_m) const {
        return robot_column_ - distance_m * std::sin(bearing_deg * radians) / scale_;
    }
    double row_of(double bearing_deg, double distance_m) const {
        return robot_row_ - distance_m * std::cos(bearing_deg * radians) / (2 * scale_);
    }

    bool inside(int column, int row) const {
        return column >= 0 && column < plot_.columns && row >= 0 && row < plot_.rows;
    }

    std::size_t index_of(int column, int row) const {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(plot_.columns) +
               static_cast<std::size_t>(column);
    }

    void put(int column, int row, std::string_view text, RadarInk ink) {
        if (inside(column, row)) {
            plot_.at(column, row) = {std::string(text), ink};
        }
    }

    /// Returns the sector of a bearing, or nullptr where there is none.
    const disparity::ScanSector* sector_at(double bearing_deg) const {
        const auto after = std::upper_bound(
            sectors_.begin(), sectors_.end(), bearing_deg,
            [](double bearing, const disparity::ScanSector& sector) { return bearing < sector.from_deg; });
        if (after == sectors_.begin()) {
            return nullptr;
        }
        const disparity::ScanSector& found = *std::prev(after);
        return bearing_deg <= found.to_deg ? &found : nullptr;
    }

    void shade_free() {
        for (int row = 0; row < plot_.rows; ++row) {
            for (int column = 0; column < plot_.columns; ++column) {
                const double x = (robot_row_ - row) * 2 * scale_;
                const double y = (robot_column_ - column) * scale_;
                const disparity::ScanSector* const sector = sector_at(std::atan2(y, x) / radians);
                if (sector != nullptr && std::hypot(x, y) <= std::min(sector->free_m, range_m_)) {
                    put(column, row, glyphs_.free, RadarInk::free);
                }
            }
        }
    }

    /// Calls `mark` with the column and row of points of an arc, close together. A short arc has at least one.
    template <typename Mark>
    void along_arc(double from_deg, double to_deg, double distance_m, Mark&& mark) const {
        const int steps = 1 + static_cast<int>((to_deg - from_deg) * radians * distance_m / (0.4 * scale_));
        for (int i = 0; i < steps; ++i) {
            const double bearing = from_deg + (to_deg - from_deg) * (i + 0.5) / steps;
            mark(column_of(bearing, distance_m), row_of(bearing, distance_m));
        }
    }

    void draw_rings() {
        if (sectors_.empty()) {
            return;
        }
        const double step = ring_step(range_m_, 2 * scale_);
        for (int i = 1; i * step < range_m_ - step / 2; ++i) {
            draw_ring(i * step);
        }
        draw_ring(range_m_);
    }

    void draw_ring(double distance_m) {
        const double from = sectors_.front().from_deg;
        along_arc(from, sectors_.back().to_deg, distance_m,
                  [this](double column, double row) { put(whole(column), whole(row), glyphs_.ring, RadarInk::ring); });
        int column = whole(column_of(from, distance_m)) + 1;
        const int row = whole(row_of(from, distance_m));
        for (const char letter : ' ' + base::number_text(distance_m) + " m") {
            put(column++, row, std::string_view(&letter, 1), letter == ' ' ? RadarInk::blank : RadarInk::label);
        }
    }

    void draw_obstacles() {
        std::vector<unsigned> blocks(plot_.cells.size());
        for (const disparity::ScanSector& sector : sectors_) {
            if (sector.state != disparity::SectorState::occupied || sector.distance_m > range_m_) {
                continue;
            }
            along_arc(sector.from_deg, sector.to_deg, sector.distance_m, [&](double column, double row) {
                if (inside(whole(column), whole(row))) {
                    const unsigned right = column >= whole(column) ? 1 : 0;
                    const unsigned lower = row >= whole(row) ? 2 : 0;
                    blocks[index_of(whole(column), whole(row))] |= 1U << (right + lower);
                }
            });
        }
        for (std::size_t i = 0; i < blocks.size(); ++i) {
            if (blocks[i] != 0) {
                plot_.cells[i] = {ascii_ ? "#" : std::string(quarters[blocks[i]]), RadarInk::obstacle};
            }
        }
    }

    const std::vector<disparity::ScanSector>& sectors_;
    double range_m_;
    bool ascii_;
    RadarGlyphs glyphs_;
    double scale_ = 1;  ///< metres per column; a row has twice as many
    int robot_column_ = 0;
    int robot_row_ = 0;
    RadarPlot plot_;
};

/// Returns the sequence that begins a colour.
std::string_view colour_of(RadarInk ink) {
    switch (ink) {
        case RadarInk::free: return "\033[32m";
        case RadarInk::ring:
        case RadarInk::label: return "\033[2m";
        case RadarInk::obstacle: return "\033[1;31m";
        case RadarInk::robot: return "\033[1m";
        case RadarInk::blank: break;
    }
    return "";
}

}  // namespace

RadarPlot draw_radar(const disparity::Scan& scan, const RadarStyle& style) {
    return RadarDrawing(scan, style).draw();
}

std::vector<std::string> radar_lines(RadarPlot plot, bool colour) {
    std::vector<std::string> lines;
    for (int row = 0; row < plot.rows; ++row) {
        int end = plot.columns;
        while (end > 0 && plot.at(end - 1, row).text == " ") {
            --end;
        }
        std::string line;
        RadarInk ink = RadarInk::blank;
        for (int column = 0; column < end; ++column) {
            const RadarCell& cell = plot.at(column, row);
            if (colour && cell.ink != ink) {
                line += ink == RadarInk::blank ? "" : "\033[0m";
                line += colour_of(cell.ink);
                ink = cell.ink;
            }
            line += cell.text;
        }
        lines.push_back(line + (ink == RadarInk::blank ? "" : "\033[0m"));
    }
    return lines;
}

double fitting_range(const disparity::Scan& scan) {
    double reach = 0;
    for (const disparity::ScanSector& sector : scan.sectors) {
        reach =
            std::max({reach, sector.free_m, sector.state == disparity::SectorState::occupied ? sector.distance_m : 0});
    }
    for (const double range : {1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 15.0, 20.0, 30.0, 40.0}) {
        if (reach <= range) {
            return scan.max_m > 0 ? std::min(range, scan.max_m) : range;
        }
    }
    return std::max(reach, scan.max_m);
}

disparity::Scan all_unknown(disparity::Scan scan) {
    for (disparity::ScanSector& sector : scan.sectors) {
        sector.state = disparity::SectorState::unknown;
        sector.free_m = 0;
    }
    return scan;
}

}  // namespace disparityd::tools
