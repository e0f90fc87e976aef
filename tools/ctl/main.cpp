// SPDX-License-Identifier: Apache-2.0
#include <stdexcept>

#include <CLI/CLI.hpp>

#include "tools/ctl/commands.h"

int main(int argc, char** argv) {
    using namespace disparityd::tools;
    CLI::App program("Shows and controls a running disparityd; records, calibrates and matches frames without one.",
                     "disparityctl");
    program.require_subcommand(0, 1);
    program.footer(
        "Examples: disparityctl status\n"
        "          disparityctl snapshot -o now.png --disparity now.pfm\n"
        "          disparityctl process walk.mkv -o out\n"
        "Exit status: 0 done; 1 the system, the daemon or damaged input stopped it; 2 arguments, input or calibration\n"
        "must be changed; 75 process was stopped by what may be over when it is tried again; 130 Ctrl-C stopped it\n"
        "before the work was done. Every sub-command has its own --help.");
    Action action;
    add_status(program, action);
    add_watch(program, action);
    add_scan(program, action);
    add_snapshot(program, action);
    add_record(program, action);
    add_process(program, action);
    add_export(program, action);
    add_verify(program, action);
    add_board(program, action);
    add_calibrate(program, action);
    add_rows(program, action);
    add_camera(program, action);
    add_sensors(program, action);
    add_trace(program, action);
    add_sources(program, action);
    add_certificates(program, action);
    return run_program(program, argc, argv, [&program, &action] {
        if (!action) {
            throw std::invalid_argument("found no sub-command, allowed: " + sub_commands(program) +
                                        "; see disparityctl --help");
        }
        return action();
    });
}
