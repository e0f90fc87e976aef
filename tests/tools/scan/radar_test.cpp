// SPDX-License-Identifier: Apache-2.0
//
// What the radar draws of scans that are made by hand, character by character.
#include "tools/ctl/scan/radar.h"

#include <algorithm>

#include <gmock/gmock.h>

namespace disparityd::test {
namespace {

using Sector = disparity::ScanSector;
using State = disparity::SectorState;
using Lines = std::vector<std::string>;

Sector unknown(double from, double to) {
    Sector sector;
    sector.from_deg = from;
    sector.to_deg = to;
    return sector;
}

Sector free_up_to(double from, double to, double metres) {
    Sector sector = unknown(from, to);
    sector.state = State::free;
    sector.free_m = metres;
    return sector;
}

Sector obstacle(double from, double to, double metres, double free_m) {
    Sector sector = free_up_to(from, to, free_m);
    sector.state = State::occupied;
    sector.distance_m = metres;
    return sector;
}

disparity::Scan scan_with(std::vector<Sector> sectors) {
    disparity::Scan scan;
    scan.max_m = 20;
    scan.sectors = std::move(sectors);
    return scan;
}

Lines drawn(const disparity::Scan& scan, int columns, int rows, double range_m, bool ascii = true) {
    return tools::radar_lines(tools::draw_radar(scan, {columns, rows, range_m, ascii}), false);
}

/// The left third is free, an obstacle is ahead, the right third is unknown.
disparity::Scan three_thirds() {
    return scan_with({unknown(-45, -15), obstacle(-15, 15, 3, 2), free_up_to(15, 45, 4)});
}

TEST(Radar, DrawsFreeOccupiedAndUnknown) {
    EXPECT_EQ(
        drawn(three_thirds(), 40, 11, 4),
        Lines({"        +++++++++++++", "    +++++.          +++++", " +++......               +++",
               "++........#########        ++ 4 m", "  .........", "    ......+++++++++", "      .++++...... ++++ 2 m",
               "        ........", "          ......", "            ...", "              ^"}));
}

TEST(Radar, DrawsBlocksOfFourQuarters) {
    EXPECT_EQ(drawn(three_thirds(), 30, 8, 4, false),
              Lines({"     ···········", " ·····░        ·····", "··░░░░░▝▀▀▀▀▀▘     ·· 4 m", "  ░░░░░░",
                     "    ░···········", "      ░░░░░░     2 m", "        ░░░", "          ▲"}));
}

TEST(Radar, DrawsAHalfCircle) {
    EXPECT_EQ(drawn(scan_with({free_up_to(-90, 0, 1), free_up_to(0, 60, 2), obstacle(60, 90, 1.5, 1)}), 48, 10, 2),
              Lines({"            +++++++++++++", "        +++++......     +++++", "      +++..........         +++",
                     "    ++.............            ++", "   ++..............             ++",
                     " ++  .......+++++++++++++         ++", " +    # ...++...........++         +",
                     "++   #    +...............+        ++", "+    #   +.................+        +",
                     "+    #   +........^........+ 1 m    + 2 m"}));
}

TEST(Radar, DrawsWhatIsBehind) {
    EXPECT_EQ(drawn(scan_with({obstacle(-180, -90, 1, 1), free_up_to(-90, 180, 1)}), 32, 9, 1),
              Lines({"    +++++++++", "  +++.......+++", " ++...........++", "+...............+", "+.......^.......#",
                     "+..............##", " ++...........##", "  +++.......###", "    ++++#####"}));
}

TEST(Radar, FitsEverySize) {
    for (int columns = 1; columns < 130; columns += 7) {
        for (int rows = 1; rows < 60; rows += 5) {
            const tools::RadarPlot plot = tools::draw_radar(three_thirds(), {columns, rows, 4, true});
            EXPECT_LE(plot.columns, std::max(columns, 20));
            EXPECT_LE(plot.rows, std::max(rows, 4));
            EXPECT_EQ(plot.cells.size(), static_cast<std::size_t>(plot.columns) * static_cast<std::size_t>(plot.rows));
        }
    }
}

TEST(Radar, LosesNoNarrowObstacle) {
    std::vector<Sector> sectors;
    sectors.reserve(360);
    for (int i = 0; i < 360; ++i) {
        sectors.push_back(unknown(-45 + i / 4.0, -45 + (i + 1) / 4.0));
    }
    for (std::size_t i = 0; i < sectors.size(); ++i) {
        auto one = sectors;
        one[i] = obstacle(one[i].from_deg, one[i].to_deg, 3.3, 0);
        std::string text;
        for (const std::string& line : drawn(scan_with(one), 40, 11, 4)) {
            text += line;
        }
        EXPECT_THAT(text, testing::HasSubstr("#")) << i;
    }
}

TEST(Radar, DrawsNothingOfScansWithoutBearings) {
    EXPECT_EQ(drawn(scan_with({}), 40, 5, 4).back(), "^");
    EXPECT_EQ(drawn(scan_with(std::vector<Sector>(72)), 40, 5, 4).back(), "^") << "as without a calibration";
}

TEST(Radar, LeavesOutWhatIsBeyondItsRange) {
    EXPECT_EQ(drawn(scan_with({obstacle(-45, 45, 3, 0)}), 40, 11, 2), drawn(scan_with({unknown(-45, 45)}), 40, 11, 2));
}

TEST(Radar, TakesAnUnknownStateForUnknown) {
    auto scan = three_thirds();
    scan.sectors[1].state = static_cast<State>(7);
    scan.sectors[1].free_m = 0;
    EXPECT_EQ(drawn(scan, 40, 11, 4), drawn(scan_with({unknown(-45, 15), free_up_to(15, 45, 4)}), 40, 11, 4));
}

TEST(Radar, ColoursChangeNoCharacter) {
    const tools::RadarPlot plot = tools::draw_radar(three_thirds(), {40, 11, 4, true});
    const Lines plain = tools::radar_lines(plot, false);
    Lines coloured = tools::radar_lines(plot, true);
    EXPECT_NE(coloured, plain);
    for (std::string& line : coloured) {
        for (std::size_t at = line.find('\033'); at != std::string::npos; at = line.find('\033')) {
            line.erase(at, line.find('m', at) + 1 - at);
        }
    }
    EXPECT_EQ(coloured, plain);
}

TEST(Radar, ChoosesARoundRange) {
    EXPECT_EQ(tools::fitting_range(three_thirds()), 4);
    EXPECT_EQ(tools::fitting_range(scan_with({obstacle(0, 1, 4.01, 0)})), 5);
    EXPECT_EQ(tools::fitting_range(scan_with({unknown(0, 1)})), 1);
    auto near = scan_with({free_up_to(0, 1, 7)});
    near.max_m = 7;
    EXPECT_EQ(tools::fitting_range(near), 7);
}

TEST(Radar, HidesWhatIsNoLongerKnown) {
    EXPECT_EQ(drawn(tools::all_unknown(three_thirds()), 40, 11, 4), drawn(scan_with({unknown(-45, 45)}), 40, 11, 4));
}

}  // namespace
}  // namespace disparityd::test
