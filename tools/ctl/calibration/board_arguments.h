// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "calibration/board/board.h"

namespace CLI {
class App;
}  // namespace CLI

namespace disparityd::tools {

/// What a user says of a board.
struct BoardArguments {
    std::optional<int> columns;
    std::optional<int> rows;
    double square_mm = 0;
    std::string board = "chessboard";
    std::optional<double> marker_mm;
    std::optional<std::string> dictionary;
};

/// Adds --columns, --rows, --board, --marker and --dictionary; --square is the caller's.
void add_board_options(CLI::App& command, BoardArguments& arguments);

/// Throws std::invalid_argument with one line for a board that cannot be found in images.
calibration::Board board_of(const BoardArguments& arguments);

}  // namespace disparityd::tools
