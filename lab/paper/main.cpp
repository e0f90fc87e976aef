// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <iostream>
#include <optional>
#include <stdexcept>

#include <CLI/CLI.hpp>

#include "kernels/step_matcher.h"
#include "lab/paper/as_described.h"
#include "lab/paper/paper_tables.h"
#include "tools/bench/line_up.h"
#include "tools/bench/machine.h"
#include "tools/bench/report.h"
#include "tools/command_line/interrupt.h"
#include "tools/command_line/number_argument.h"
#include "tools/command_line/program.h"

namespace disparityd::lab {
namespace {

struct PaperArguments {
    std::vector<std::string> pairs;
    std::string data;
    std::optional<int> disparities;
    std::optional<int> rounds;
    std::optional<double> seconds;
};

/// Ours and the reference on one thread, ours on all cores too, and naive code as the paper describes it.
std::vector<bench::Measurement> measure(const bench::StereoPair& pair, const bench::Patience& patience,
                                        bench::WorkerPools& pools) {
    std::map<std::string, MatchOptions> options;
    for (const Method method : {Method::sad, Method::census, Method::sgm}) {
        options["cpu/" + std::string(to_string(method))] = default_options(method, {0, pair.disparities});
    }
    std::vector<int> threads{1};
    if (const int cores = bench::allowed_cores(); cores > 1) {
        threads.push_back(cores);
    }
    bench::Contestants all =
        line_up(pair, {{"cpu", "naive"}, bench::parse_instruction_sets("best"), threads}, options, pools);
    for (const Method method : {Method::sad, Method::census, Method::sgm}) {
        const std::string name(to_string(method));
        const MatcherConfig config{pair.left.cols, pair.left.rows, options.at("cpu/" + name)};
        const auto create = [&] { return std::make_unique<StepMatcher>(config, steps_as_described()); };
        for (auto& one : bench::make_with(create, pair, "paper/" + name, "scalar", pools)) {
            all.push_back(std::move(one));
        }
    }
    return alternate(pair, all, patience);
}

int run(const PaperArguments& arguments) {
    std::vector<bench::PairRequest> pairs =
        bench::parse_pairs(arguments.pairs.empty() ? std::vector<std::string>{"paper"} : arguments.pairs);
    bench::Patience patience;
    patience.rounds = arguments.rounds.value_or(patience.rounds);
    patience.seconds = arguments.seconds.value_or(patience.seconds);
    const std::vector<datasets::DatasetScene> found = bench::find_scenes(arguments.data);
    tools::catch_interrupts();
    bench::print_head(true, std::cout);
    bench::WorkerPools pools;
    std::vector<bench::Measurement> all;
    for (bench::PairRequest& pair : pairs) {
        if (pair.rendered()) {
            throw std::invalid_argument("--pair: found a rendered pair, allowed: cones, tsukuba, teddy, sawtooth");
        }
        pair.disparities = arguments.disparities.value_or(pair.disparities);
        if (!tools::interrupted() && available(pair, found)) {
            const std::vector<bench::Measurement> some = measure(load(pair, found), patience, pools);
            all.insert(all.end(), some.begin(), some.end());
        }
    }
    print_paper_tables(all, std::cout);
    return tools::interrupted() ? tools::exit_interrupted : tools::exit_done;
}

}  // namespace
}  // namespace disparityd::lab

int main(int argc, char** argv) {
    using namespace disparityd;
    CLI::App program("Tables 1 and 2 of the paper beside our times on its scenes, in Markdown.", "disparity-paper");
    program.footer(
        "Exit status: 0 done; 1 the system refused; 2 arguments or data must be changed; 130 ended by Ctrl-C.\n"
        "Example: disparity-paper --data ~/stereo-data --rounds 31 --seconds 3");
    lab::PaperArguments arguments;
    program.add_option("--pair", arguments.pairs, "one of the paper's scenes; may be repeated; default: all four")
        ->allow_extra_args(false)
        ->type_name("PAIR");
    program.add_option("--data", arguments.data, "folder with the paper's scenes; default: what DISPARITYD_DATA names")
        ->type_name("DIR");
    tools::add_integer(program, "--disparities", arguments.disparities, 16, 256, "default: the paper's of the scene");
    tools::add_integer(program, "--rounds", arguments.rounds, 1, 100000,
                       "highest number of runs of each contestant; default 15");
    tools::add_real(program, "--seconds", arguments.seconds, 0, 3600,
                    "time for each matcher and pair; a slow one runs at least three times; default 0.8");
    return tools::run_program(program, argc, argv, [&arguments] { return lab::run(arguments); });
}
