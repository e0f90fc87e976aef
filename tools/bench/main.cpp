// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <sstream>
#include <stdexcept>

#include <CLI/CLI.hpp>

#include "tools/bench/line_up.h"
#include "tools/bench/machine.h"
#include "tools/bench/report.h"
#include "tools/bench/roofline.h"
#include "tools/bench/step_work.h"
#include "tools/command_line/interrupt.h"
#include "tools/command_line/match_arguments.h"
#include "tools/command_line/number_argument.h"
#include "tools/command_line/program.h"
#include "tools/images/image_file.h"

namespace disparityd::bench {
namespace {

constexpr int max_threads = 256;

struct BenchArguments {
    std::vector<std::string> pairs;
    std::vector<std::string> contestants;
    std::vector<std::string> threads;
    std::string isa = "best";
    std::string data;
    std::string json;
    tools::MatchArguments match;
    std::optional<int> rounds;
    std::optional<double> seconds;
    std::optional<int> roofline;
    bool markdown = false;
};

std::vector<int> threads_of(const BenchArguments& arguments) {
    const int cores = allowed_cores();
    if (arguments.threads.empty()) {
        std::vector<int> threads{1};
        for (int count = 2; count < cores; count *= 2) {
            threads.push_back(count);
        }
        if (cores > 1) {
            threads.push_back(cores);
        }
        return threads;
    }
    std::vector<int> threads;
    for (const std::string& text : arguments.threads) {
        const int count =
            text.size() > 3 || text.find_first_not_of("0123456789") != std::string::npos ? 0 : std::atoi(text.c_str());
        if (count < 1 || count > max_threads) {
            throw std::invalid_argument("--threads: found '" + text + "', allowed: a whole number from 1 to " +
                                        std::to_string(max_threads));
        }
        threads.push_back(count);
    }
    return threads;
}

std::vector<PairRequest> pairs_of(const BenchArguments& arguments) {
    std::vector<PairRequest> pairs =
        parse_pairs(arguments.pairs.empty() ? std::vector<std::string>{"paper", "rendered"} : arguments.pairs);
    for (PairRequest& pair : pairs) {
        pair.disparities = arguments.match.disparities().value_or(pair.disparities);
    }
    return pairs;
}

class Benchmark {
public:
    explicit Benchmark(const BenchArguments& arguments)
        : arguments_(arguments),
          pairs_(pairs_of(arguments)),
          selection_{arguments.contestants, parse_instruction_sets(arguments.isa), threads_of(arguments)},
          roofline_(pools_, selection_.instruction_sets) {
        check_contestants(selection_.contestants);
        arguments.match.check_used(methods_of(selection_.contestants));
        patience_.rounds = arguments.rounds.value_or(patience_.rounds);
        patience_.seconds = arguments.seconds.value_or(patience_.seconds);
        options_for(default_options(Method::sgm).range.count);  // refuses options that do not fit together
        // Only when it is needed: who wants rendered pairs need not care what DISPARITYD_DATA names.
        if (!arguments.data.empty() ||
            !std::all_of(pairs_.begin(), pairs_.end(), [](const PairRequest& pair) { return pair.rendered(); })) {
            found_ = find_scenes(arguments.data);
        }
    }

    int run() {
        tools::catch_interrupts();
        write_json_file();  // where that cannot be, it is said now and not at the end
        print_head(arguments_.markdown, text());
        for (const PairRequest& request : pairs_) {
            if (!tools::interrupted() && available(request, found_)) {
                measure(load(request, found_));
            }
        }
        if (arguments_.json == "-") {
            print_json(all_, std::cout);
        }
        if (tools::interrupted()) {
            tools::print_note("stopped by " + tools::interrupted_by() + "; the tables hold what was measured before");
            return tools::exit_interrupted;
        }
        return tools::exit_done;
    }

private:
    /// Where text for people goes: nowhere when standard output is for JSON.
    std::ostream& text() { return arguments_.json == "-" ? nowhere_ : std::cout; }

    std::map<std::string, MatchOptions> options_for(int disparities) const {
        std::map<std::string, MatchOptions> options;
        for (const Method method : {Method::sad, Method::census, Method::sgm}) {
            options["cpu/" + std::string(to_string(method))] = arguments_.match.options(method, disparities);
        }
        return options;
    }

    void measure(const StereoPair& pair) {
        const auto options = options_for(pair.disparities);
        const Contestants contestants = line_up(pair, selection_, options, pools_);
        const std::vector<Measurement> measurements = alternate(pair, contestants, patience_);
        print_measurements(measurements, arguments_.markdown, text());
        if (arguments_.roofline.value_or(1) != 0 && !tools::interrupted()) {
            roofline_.print(measurements, options, arguments_.markdown, text());
        }
        text() << std::flush;
        all_.insert(all_.end(), measurements.begin(), measurements.end());
        write_json_file();
    }

    void write_json_file() const {
        if (!arguments_.json.empty() && arguments_.json != "-") {
            std::ostringstream list;
            print_json(all_, list);
            images::write_file(arguments_.json, list.str());
        }
    }

    const BenchArguments& arguments_;
    std::vector<PairRequest> pairs_;
    Selection selection_;
    Patience patience_;
    WorkerPools pools_;
    Roofline roofline_;
    std::vector<datasets::DatasetScene> found_;
    std::vector<Measurement> all_;
    std::ostream nowhere_{nullptr};
};

void add_arguments(CLI::App& program, BenchArguments& arguments) {
    const auto several = [&](const std::string& name, std::vector<std::string>& words, const std::string& description) {
        return program.add_option(name, words, description)->allow_extra_args(false);
    };
    several("--pair", arguments.pairs,
            "pairs to match: paper (its four scenes with its D), one of cones, tsukuba, teddy, sawtooth, rendered (six "
            "sizes), or WIDTHxHEIGHTxDISPARITIES; may be repeated; default paper and rendered")
        ->type_name("PAIR");
    several("--contestant", arguments.contestants,
            "matchers to time: cpu, cuda, naive, opencv, or one method of them such as cpu/sgm or opencv/3way; may be "
            "repeated; default: all that run here, naive only up to 25 million candidates per frame")
        ->type_name("NAME");
    program.add_option("--isa", arguments.isa, "vector instructions of cpu: best, all, or a name; default best")
        ->type_name("NAME");
    several("--threads", arguments.threads, "number of threads; may be repeated; default 1, 2, 4 .. cores")
        ->type_name("N");
    tools::add_integer(program, "--rounds", arguments.rounds, 1, 100000,
                       "highest number of runs of each contestant; default 15");
    tools::add_real(program, "--seconds", arguments.seconds, 0, 3600,
                    "time for each matcher and pair; a slow one runs at least three times; default 0.8");
    program.add_option("--data", arguments.data, "folder with the paper's scenes; default: what DISPARITYD_DATA names")
        ->type_name("DIR");
    tools::add_switch(program, "roofline", arguments.roofline,
                      "time of each of our steps beside the least time that its bytes and operations need; default on");
    program.add_option("--json", arguments.json, "a list of objects to a file; -: to standard output, without tables")
        ->type_name("FILE");
    program.add_flag("--markdown", arguments.markdown, "tables in Markdown");
    arguments.match.add_to(program, "default: the pair's");
}

}  // namespace
}  // namespace disparityd::bench

int main(int argc, char** argv) {
    using namespace disparityd;
    CLI::App program("Measures how long matching takes: ours, plain code and OpenCV, in alternation in one run.",
                     "disparity-bench");
    program.footer(
        "A run is a frame from a rectified grey pair to filtered disparities; every contestant has matched one "
        "before.\n" +
        bench::step_work_legend() +
        "\nx naive, x scalar, x 3WAY: how many times as fast as the reference as compiled, the reference not "
        "vectorised\n"
        "(both of the same method, 1 thread), and OpenCV's MODE_SGBM_3WAY with as many threads.\n"
        "Ctrl-C ends it; what was measured before is printed.\n"
        "Exit status: 0 done; 1 the system refused; 2 arguments or data must be changed; 130 ended by Ctrl-C.\n"
        "Example: disparity-bench --pair 640x480x64 --contestant cpu --contestant opencv/3way --isa all --json "
        "out.json");
    bench::BenchArguments arguments;
    bench::add_arguments(program, arguments);
    return tools::run_program(program, argc, argv, [&arguments] { return bench::Benchmark(arguments).run(); });
}
