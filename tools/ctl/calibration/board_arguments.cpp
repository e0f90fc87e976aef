// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/calibration/board_arguments.h"

#include <stdexcept>

#include <CLI/CLI.hpp>

#include "tools/command_line/number_argument.h"
#include "tools/command_line/table.h"

namespace disparityd::tools {
namespace {

calibration::BoardMarkers markers_of(const BoardArguments& arguments, const calibration::Board& board) {
    if (!arguments.marker_mm) {
        throw std::invalid_argument(
            "--marker: is missing; a board with markers needs it: the side of a marker in mm, measured on the board");
    }
    // The detector finds no marker without a rim, and none of a few pixels.
    const double part = *arguments.marker_mm / board.square_mm;
    if (!(part >= 0.3 && part <= 0.95)) {
        throw std::invalid_argument("--marker: found " + fixed(*arguments.marker_mm, 2) +
                                    ", allowed: " + fixed(0.3 * board.square_mm, 2) + " to " +
                                    fixed(0.95 * board.square_mm, 2) + " mm, 0.3 to 0.95 of the square's side");
    }
    const std::string name = arguments.dictionary.value_or("4x4");
    const calibration::MarkerFamily* family = calibration::marker_family(name);
    if (family == nullptr) {
        throw std::invalid_argument("--dictionary: found '" + name + "', allowed: 4x4, 5x5 or 6x6");
    }
    const int needed = (board.columns + 1) * (board.rows + 1) / 2;
    if (needed > static_cast<int>(family->codes.size())) {
        throw std::invalid_argument("--columns, --rows: a board of this size has " + std::to_string(needed) +
                                    " markers, allowed: " + std::to_string(family->codes.size()));
    }
    return {family, part};
}

}  // namespace

void add_board_options(CLI::App& command, BoardArguments& arguments) {
    add_integer(command, "--columns", arguments.columns, 3, 64, "inner corners along a row of the board; default 9");
    add_integer(command, "--rows", arguments.rows, 3, 64, "inner corners along a column; default 6");
    command.add_option("--board", arguments.board, "chessboard or charuco; default chessboard")->type_name("KIND");
    command.add_option("--marker", arguments.marker_mm, "charuco: side of a marker in mm, as measured")
        ->type_name("MM");
    command.add_option("--dictionary", arguments.dictionary, "charuco: 4x4, 5x5 or 6x6, numbers 0 to 249; default 4x4")
        ->type_name("NAME");
}

calibration::Board board_of(const BoardArguments& arguments) {
    calibration::Board board{arguments.columns.value_or(9), arguments.rows.value_or(6), arguments.square_mm, {}};
    if (!(board.square_mm >= 1 && board.square_mm <= 1000)) {
        throw std::invalid_argument("--square: found " + fixed(board.square_mm, 2) +
                                    ", allowed: 1 to 1000, the side of a square in mm, measured on the board");
    }
    if (arguments.board != "chessboard" && arguments.board != "charuco") {
        throw std::invalid_argument("--board: found '" + arguments.board + "', allowed: chessboard or charuco");
    }
    if (arguments.board == "charuco") {
        board.markers = markers_of(arguments, board);
    } else if (arguments.marker_mm || arguments.dictionary) {
        throw std::invalid_argument(
            "--marker, --dictionary: a chessboard has no markers, allowed: with --board charuco");
    }
    return board;
}

}  // namespace disparityd::tools
