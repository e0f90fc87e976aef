// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <iostream>
#include <memory>

#include <CLI/CLI.hpp>

#include "tools/command_line/table.h"
#include "tools/ctl/calibration/board_arguments.h"
#include "tools/ctl/calibration/board_page.h"
#include "tools/ctl/commands.h"
#include "tools/ctl/output_file.h"
#include "tools/images/image_file.h"

namespace disparityd::tools {
namespace {

struct PrintArguments {
    std::string output;
    std::string paper = "a4";
    BoardArguments board;
    bool force = false;
};

/// Returns the number without decimals that say nothing.
std::string short_text(double number) {
    return base::number_text(std::round(number * 100) / 100);
}

/// Returns the command that takes this board.
std::string command_for(const BoardArguments& arguments, const calibration::Board& board) {
    std::string command = "disparityctl calibrate SOURCE -o my.yml --columns " + std::to_string(board.columns) +
                          " --rows " + std::to_string(board.rows) + " --square " + short_text(board.square_mm);
    if (board.markers) {
        command += " --board charuco --marker " + short_text(*arguments.marker_mm) + " --dictionary " +
                   std::string(board.markers->family->name);
    }
    return command;
}

int print_board(PrintArguments arguments) {
    images::check_ending(arguments.output, {".pdf"});
    check_output(arguments.output, arguments.force);
    if (arguments.board.board == "charuco" && !arguments.board.marker_mm) {
        // 18 of 25 mm; half millimetres can be measured.
        arguments.board.marker_mm = std::round(0.72 * arguments.board.square_mm * 2) / 2;
    }
    const calibration::Board board = board_of(arguments.board);
    const std::string command = command_for(arguments.board, board);
    const std::string page = board_page(
        board, paper_of_name(arguments.paper),
        {"Print at 100 % (actual size, no fit to page), then measure the bar and a square. Glue the sheet to "
         "something flat and stiff.",
         command});
    images::write_file(arguments.output, page);
    std::cout << arguments.output << ": print it at 100 %, measure a square, then\n  " << command << '\n';
    return exit_done;
}

}  // namespace

void add_board(CLI::App& program, Action& action) {
    CLI::App& command =
        *program.add_subcommand("board", "Write a board to print, chessboard or ChArUco, for disparityctl calibrate.");
    const auto arguments = std::make_shared<PrintArguments>();
    arguments->board.square_mm = 25;
    command.add_option("-o,--output", arguments->output, "PDF to write")->type_name("FILE")->required();
    command.add_option("--paper", arguments->paper, "a4 or letter; default a4")->type_name("NAME");
    command.add_option("--square", arguments->board.square_mm, "side of a square in mm; default 25")->type_name("MM");
    add_board_options(command, arguments->board);
    command.add_flag("--force", arguments->force, "replace the file");
    command.footer(
        "A board of 10 x 7 squares has 9 x 6 inner corners. What counts is the square as measured on the paper:\n"
        "give that to disparityctl calibrate. A ChArUco board may be partly hidden or reach beyond the image.\n"
        "Example: disparityctl board -o board.pdf --board charuco --paper letter");
    command.callback([arguments, &action] { action = [arguments] { return print_board(*arguments); }; });
}

}  // namespace disparityd::tools
