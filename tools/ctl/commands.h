// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/command_line/program.h"

namespace CLI {
class App;
}  // namespace CLI

/// Adds the sub-commands of disparityctl. Each adds itself and its options to the program, and sets `action` when the
/// user has chosen it.
namespace disparityd::tools {

void add_status(CLI::App& program, Action& action);
void add_watch(CLI::App& program, Action& action);
void add_scan(CLI::App& program, Action& action);
void add_snapshot(CLI::App& program, Action& action);
void add_record(CLI::App& program, Action& action);
void add_process(CLI::App& program, Action& action);
void add_export(CLI::App& program, Action& action);
void add_calibrate(CLI::App& program, Action& action);
void add_verify(CLI::App& program, Action& action);
void add_board(CLI::App& program, Action& action);
void add_rows(CLI::App& program, Action& action);
void add_certificates(CLI::App& program, Action& action);
void add_camera(CLI::App& program, Action& action);
void add_sensors(CLI::App& program, Action& action);
void add_trace(CLI::App& program, Action& action);
void add_sources(CLI::App& program, Action& action);

}  // namespace disparityd::tools
