// SPDX-License-Identifier: Apache-2.0
//
// Simulates a live pipeline whose source is faster than the work, for numbers of workers that this machine has not got:
// how old frames are when they are published, with the admission of the pipeline and without.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <utility>
#include <vector>

#include "pipeline/admission.h"

namespace disparityd::lab {
namespace {

using std::chrono::duration_cast;
using Time = pipeline::Admission::Time;
using Milliseconds = std::chrono::duration<double, std::milli>;

constexpr double step_ms = 0.02;
constexpr int slots = 4;

/// A stage's time for a frame on one worker and on two, which say how much of it is not shared (Amdahl).
struct Stage {
    double one_ms = 0;
    double two_ms = 0;

    /// Returns how much of a frame is done in a millisecond on so many cores.
    double speed(double cores) const {
        if (cores < 1) {
            return cores / one_ms;
        }
        const double alone = std::clamp(2 * two_ms - one_ms, 0.0, one_ms);
        return 1 / (alone + (one_ms - alone) / cores);
    }
};

struct Result {
    double p50 = 0;
    double p99 = 0;
    double rate = 0;
};

struct Work {
    double captured = 0;
    double done = 0;  ///< of the stage, 0 .. 1
};

/// The pipeline by a clock of its own. Stages that work share the cores evenly.
class Simulation {
public:
    Simulation(const std::vector<Stage>& stages, int workers, double interval_ms, bool admission)
        : stages_(stages), workers_(workers), interval_(interval_ms), working_(stages.size()), waiting_(stages.size()) {
        if (admission) {
            admission_.emplace(stages.size(), stages.size() - 1, slots, workers);
        }
    }

    Result run(double seconds) {
        constexpr double warm_up_ms = 2000;
        for (; now_ < 1000 * seconds; now_ += step_ms) {
            if (now_ >= next_capture_) {
                newest_ = Work{next_capture_, 0};
                next_capture_ += interval_;
            }
            hand_on();
            compute();
            if (now_ < warm_up_ms) {
                ages_.clear();
            }
        }
        std::sort(ages_.begin(), ages_.end());
        const auto at = [&](double share) {
            return ages_[static_cast<std::size_t>(share * static_cast<double>(ages_.size() - 1))];
        };
        return {at(0.5), at(0.99), 1000 * static_cast<double>(ages_.size()) / (1000 * seconds - warm_up_ms)};
    }

private:
    Time clock() const { return Time(duration_cast<Time::duration>(Milliseconds(now_))); }

    /// Lets stages that are free begin, the last one first.
    void hand_on() {
        for (std::size_t i = stages_.size(); i-- > 0;) {
            if (working_[i] || (i + 1 < stages_.size() && waiting_[i + 1])) {
                continue;
            }
            if (i == 0 && newest_ && in_flight() < slots && may_begin()) {
                waiting_[0] = std::exchange(newest_, std::nullopt);
            }
            if (waiting_[i]) {
                working_[i] = std::exchange(waiting_[i], std::nullopt);
                if (admission_) {
                    admission_->begins(i, clock());
                }
            }
        }
    }

    bool may_begin() const {
        if (!admission_) {
            return true;
        }
        const auto opens = admission_->opens(clock());
        return opens && *opens <= clock();
    }

    int in_flight() const {
        const auto there = [](const auto& work) { return work.has_value(); };
        return static_cast<int>(std::count_if(working_.begin(), working_.end(), there) +
                                std::count_if(waiting_.begin(), waiting_.end(), there));
    }

    void compute() {
        const auto busy =
            std::count_if(working_.begin(), working_.end(), [](const auto& work) { return work.has_value(); });
        for (std::size_t i = stages_.size(); i-- > 0;) {
            if (!working_[i]) {
                continue;
            }
            working_[i]->done += step_ms * stages_[i].speed(static_cast<double>(workers_) / static_cast<double>(busy));
            if (working_[i]->done < 1) {
                continue;
            }
            Work work = *std::exchange(working_[i], std::nullopt);
            work.done = 0;
            if (admission_) {
                admission_->ends(i, clock());
            }
            if (i + 1 < stages_.size()) {
                waiting_[i + 1] = work;
            } else {
                ages_.push_back(now_ - work.captured);
            }
        }
    }

    const std::vector<Stage>& stages_;
    const int workers_;
    const double interval_;
    std::optional<pipeline::Admission> admission_;
    double now_ = 0;
    double next_capture_ = 0;
    std::optional<Work> newest_;
    std::vector<std::optional<Work>> working_;
    std::vector<std::optional<Work>> waiting_;  ///< in front of each stage
    std::vector<double> ages_;
};

int run(int argc, char** argv) {
    std::vector<Stage> stages;
    for (int i = 2; i + 1 < argc; i += 2) {
        stages.push_back({std::atof(argv[i]), std::atof(argv[i + 1])});
    }
    const double rate = argc > 1 ? std::atof(argv[1]) : 0;
    const bool all_positive = std::all_of(stages.begin(), stages.end(),
                                          [](const Stage& stage) { return stage.one_ms > 0 && stage.two_ms > 0; });
    if (rate <= 0 || stages.size() < 2 || !all_positive || argc % 2 != 0) {
        std::fprintf(
            stderr,
            "usage: disparity-overload RATE ONE TWO ONE TWO ...\n"
            "RATE: frames per second of the source. Of each stage, the last of which publishes, the milliseconds "
            "for a frame with one worker and with two\n");
        return 2;
    }
    std::printf(
        "| workers | a frame alone, ms | before: p50, p99 ms | frames/s | now: p50, p99 ms | frames/s |\n"
        "| --- | --- | --- | --- | --- | --- |\n");
    for (const int workers : {1, 2, 3, 4, 6, 8, 12}) {
        double alone = 0;
        for (const Stage& stage : stages) {
            alone += 1 / stage.speed(workers);
        }
        constexpr double simulated_s = 20;
        const Result before = Simulation(stages, workers, 1000 / rate, false).run(simulated_s);
        const Result now = Simulation(stages, workers, 1000 / rate, true).run(simulated_s);
        std::printf("| %d | %.1f | %.1f, %.1f | %.1f | %.1f, %.1f | %.1f |\n", workers, alone, before.p50, before.p99,
                    before.rate, now.p50, now.p99, now.rate);
    }
    return 0;
}

}  // namespace
}  // namespace disparityd::lab

int main(int argc, char** argv) {
    return disparityd::lab::run(argc, argv);
}
