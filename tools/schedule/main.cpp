// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <iostream>
#include <stdexcept>
#include <thread>

#include <CLI/CLI.hpp>

#include "kernels/cpu/backend.h"
#include "pipeline/worker_pool.h"
#include "tools/command_line/number_argument.h"
#include "tools/command_line/program.h"
#include "tools/command_line/table.h"
#include "tools/schedule/task_times.h"

namespace disparityd::schedule {
namespace {

struct Arguments {
    std::optional<int> width;
    std::optional<int> height;
    std::optional<int> disparities;
    std::vector<int> workers;
    std::string instruction_set;
    bool markdown = false;
};

std::int64_t target_of(const Arguments& arguments) {
    const auto sets = cpu::instruction_sets();
    if (sets.empty()) {
        throw std::runtime_error("the back end \"cpu\" does not run on this machine");
    }
    std::string names;
    for (const cpu::InstructionSet& set : sets) {
        if (arguments.instruction_set.empty() || set.name == arguments.instruction_set) {
            return set.target;
        }
        names += (names.empty() ? "" : ", ") + set.name;
    }
    throw std::invalid_argument("--isa: found \"" + arguments.instruction_set + "\", allowed here: " + names);
}

// Both volumes, written once and read once.
double volume_gigabytes(const Frame& frame) {
    return 4e-9 * frame.width * frame.height * frame.disparities;
}

int print_schedule(const Arguments& arguments) {
    Frame frame;
    frame.width = arguments.width.value_or(450);
    frame.height = arguments.height.value_or(375);
    frame.disparities = arguments.disparities.value_or(128);
    frame.target = target_of(arguments);
    const int cores = static_cast<int>(std::max(std::thread::hardware_concurrency(), 1U));
    const double handing_over = cores > 1 ? measure_handing_over(frame) : 1;
    const TaskTimes alone = measure_alone(frame, 1);
    std::cout << frame.width << " x " << frame.height << ", " << frame.disparities << " disparities; of "
              << division_of(frame, 1).rows_at_once << " rows at once on one core: costs "
              << tools::fixed(alone.costs, 1) << " us, paths " << tools::fixed(alone.aggregate[0], 1) << " and "
              << tools::fixed(alone.aggregate[1], 1) << " us, winners " << tools::fixed(alone.winners, 1)
              << " us; paths after a row of another core: x " << tools::fixed(handing_over, 2) << "\n\n";
    tools::Table table({"workers", "measured ms", "simulated ms", "speed-up", "efficiency %", "volumes GB/s"});
    double one = 0;
    for (const int workers : arguments.workers) {
        const Division division = division_of(frame, workers);
        TaskTimes times = measure_alone(frame, workers);
        if (workers > 2) {
            times.aggregate[0] *= handing_over;
            times.aggregate[1] *= handing_over;
        }
        const double simulated = simulate(division, times, workers);
        one = one == 0 ? simulate(division_of(frame, 1), alone, 1) : one;
        std::string measured = "-";
        if (workers <= cores) {
            pipeline::WorkerPool pool(workers);
            const pipeline::WorkerPool::ComputeSlot slot(pool);
            measured = tools::fixed(measure_frame(frame, pool) / 1000, 2);
        }
        table.add({std::to_string(workers), measured, tools::fixed(simulated / 1000, 2),
                   tools::fixed(one / simulated, 2), tools::fixed(100 * one / simulated / workers, 0),
                   tools::fixed(volume_gigabytes(frame) / (simulated * 1e-6), 0)});
    }
    arguments.markdown ? table.print_markdown(std::cout) : table.print(std::cout);
    return tools::exit_done;
}

}  // namespace
}  // namespace disparityd::schedule

int main(int argc, char** argv) {
    using namespace disparityd;
    CLI::App program("How SGM would scale on a machine with more cores: a simulated schedule from measured times.",
                     "sgm-schedule");
    program.footer(
        "Example: sgm-schedule --width 1280 --height 720 --disparities 128 --workers 1,2,4,8\n"
        "The times of costs, paths and winners of a row are measured on this machine, and events are simulated with\n"
        "the rules by which the workers divide the rows. Simulated: every worker has a core as fast as this one "
        "alone,\n"
        "and memory keeps up; the last column says with how much of it. measured: the same on this machine's cores.\n"
        "Exit status: 0 done; 1 the system refused; 2 arguments must be changed.");
    schedule::Arguments arguments;
    tools::add_integer(program, "--width", arguments.width, 1, 8192, "default 450");
    tools::add_integer(program, "--height", arguments.height, 2, 8192, "default 375");
    tools::add_integer(program, "--disparities", arguments.disparities, 16, 256, "default 128");
    program.add_option("--workers", arguments.workers, "numbers of workers; default 1,2,3,4,6,8,12,16,20,24,32")
        ->delimiter(',')
        ->check(CLI::Range(1, 64))
        ->type_name("N,..");
    program.add_option("--isa", arguments.instruction_set, "instruction set; default: the best of this machine")
        ->type_name("NAME");
    program.add_flag("--markdown", arguments.markdown, "the table in Markdown");
    return tools::run_program(program, argc, argv, [&arguments] {
        if (arguments.workers.empty()) {
            arguments.workers = {1, 2, 3, 4, 6, 8, 12, 16, 20, 24, 32};
        }
        return schedule::print_schedule(arguments);
    });
}
