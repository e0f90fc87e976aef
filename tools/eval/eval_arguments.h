// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "tools/command_line/match_arguments.h"
#include "tools/command_line/scan_arguments.h"

namespace disparityd::eval {

/// What the user of disparity-eval has asked for; --help says what each means.
struct EvalArguments {
    std::vector<std::string> data;
    std::vector<std::string> methods;
    std::vector<std::string> backends;
    tools::MatchArguments match;
    tools::ScanArguments scan_options;
    std::vector<std::string> conditions;
    std::string pictures;
    std::optional<double> scale;
    std::optional<int> repeat;
    std::optional<int> workers;
    std::optional<int> halves;  ///< the seed
    std::optional<double> noise;
    bool shared_noise = false;
    bool opencv = false;
    bool fair = false;
    bool fractions = false;
    bool confidence = false;
    bool thin = false;
    bool scan = false;
    bool trust = false;
    bool near_guard = false;
    bool temporal = false;
    bool paper = false;
    bool benchmark = false;
    std::vector<std::string> results;      ///< NAME=WHERE, files of other programs
    std::vector<std::string> confidences;  ///< NAME=WHERE
    std::vector<std::string> regions;      ///< names; empty = all
    std::string holes = "bad";
    bool csv = false;
    bool incomplete = false;
    bool json = false;
    bool markdown = false;
};

/// Adds the options that fill in `arguments`, which must live as long as the program.
void add_arguments(CLI::App& program, EvalArguments& arguments);

}  // namespace disparityd::eval
