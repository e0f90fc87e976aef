// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "clients/cpp/disparity_client.hpp"

/// Draws an obstacle scan from above, with characters: the robot at the bottom, ahead is up, left is left. What is free
/// is shaded, obstacles are blocks, what is unknown is blank. Rings say how far it is.
namespace disparityd::tools {

/// How a plot is drawn. A character is taken to be twice as high as it is wide.
struct RadarStyle {
    int columns = 80;     ///< the plot has at most so many, at least 20
    int rows = 22;        ///< at most so many, at least 4
    double range_m = 20;  ///< what is farther is not drawn
    bool ascii = false;   ///< else block characters in UTF-8, with four blocks for each character
};

/// What a character shows: for its colour.
enum class RadarInk : std::uint8_t { blank, free, ring, label, obstacle, robot };

struct RadarCell {
    std::string text = " ";  ///< one character
    RadarInk ink = RadarInk::blank;
};

struct RadarPlot {
    int columns = 0;
    int rows = 0;
    std::vector<RadarCell> cells;  ///< row by row, the upper one first

    RadarCell& at(int column, int row) {
        return cells[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                     static_cast<std::size_t>(column)];
    }
};

RadarPlot draw_radar(const disparity::Scan& scan, const RadarStyle& style);

/// Returns the lines of a plot, without blanks at their ends; with a terminal's colours where they are wanted.
std::vector<std::string> radar_lines(RadarPlot plot, bool colour);

/// Returns a round range that holds all that a scan shows, at most its own.
double fitting_range(const disparity::Scan& scan);

/// Returns the same sectors, of which nothing is known.
disparity::Scan all_unknown(disparity::Scan scan);

}  // namespace disparityd::tools
