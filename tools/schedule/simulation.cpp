// SPDX-License-Identifier: Apache-2.0
#include "tools/schedule/simulation.h"

#include <algorithm>
#include <array>
#include <queue>
#include <vector>

#include "kernels/cpu/sgm/sgm_kernels.h"

namespace disparityd::schedule {

namespace {

using cpu::RowGroup;

// Events in the order of time: what each worker is about to do.
class Simulation {
public:
    Simulation(const Division& division, const TaskTimes& times, int workers)
        : division_(division),
          times_(times),
          groups_(division.plan.groups()),
          scheduler_(groups_),
          groups_without_sums_(groups_[0][0] + groups_[1][0]),
          workers_(static_cast<std::size_t>(workers)) {
        for (std::size_t sweep = 0; sweep < 2; ++sweep) {
            done_[sweep].assign(static_cast<std::size_t>(groups_[sweep][0] + groups_[sweep][1]), 0);
        }
    }

    double run() {
        for (std::size_t i = 0; i < workers_.size(); ++i) {
            workers_[i].turn = scheduler_.join();
            schedule(i, 0);
        }
        while (!events_.empty()) {
            const Event event = events_.top();
            events_.pop();
            now_ = event.time;
            (this->*workers_[event.worker].next)(event.worker);
        }
        return now_;
    }

private:
    struct Event {
        double time;
        std::size_t worker;
        bool operator>(const Event& other) const {
            return time > other.time || (time == other.time && worker > other.worker);
        }
    };

    struct Worker {
        cpu::SweepScheduler::Worker turn;
        RowGroup group;
        int groups_of_task = 0;
        int untold = 0;  // groups of the first part that nobody has been told of
        int steps = 0;
        void (Simulation::*next)(std::size_t) = &Simulation::take;
    };

    void schedule(std::size_t i, double delay) { events_.push({now_ + delay, i}); }

    void take(std::size_t i) {
        Worker& worker = workers_[i];
        if (worker.groups_of_task == division_.plan.groups_of_task()) {
            tell(worker);
            scheduler_.leave(worker.turn);
            worker.turn = scheduler_.join();
            worker.groups_of_task = 0;
        }
        if (!scheduler_.claim(worker.turn, worker.group)) {
            tell(worker);
            scheduler_.leave(worker.turn);
            return;
        }
        ++worker.groups_of_task;
        if (worker.group.part == 1) {
            tell(worker);
        }
        worker.steps = 0;
        worker.next = &Simulation::aggregate;
        schedule(i, worker.group.part == 0 || groups_without_sums_ > 0 ? times_.costs : 0);
    }

    // Until the next report, if the row before is far enough.
    void aggregate(std::size_t i) {
        Worker& worker = workers_[i];
        const int all = cpu::steps_of(division_.width, division_.rows_at_once);
        const int end = std::min(worker.steps + division_.plan.steps_at_once(), all);
        const auto sweep = static_cast<std::size_t>(worker.group.sweep);
        const auto index = static_cast<std::size_t>(worker.group.index);
        if (index > 0 && done_[sweep][index - 1] < std::min(end + 1, division_.width)) {
            waiting_.push_back(i);
            return;
        }
        const double part = static_cast<double>(end - worker.steps) / all;
        worker.steps = end;
        worker.next = &Simulation::report;
        schedule(i, part * times_.aggregate[worker.group.part]);
    }

    void report(std::size_t i) {
        Worker& worker = workers_[i];
        const int all = cpu::steps_of(division_.width, division_.rows_at_once);
        done_[static_cast<std::size_t>(worker.group.sweep)][static_cast<std::size_t>(worker.group.index)] =
            cpu::done_after(worker.steps, division_.width, division_.rows_at_once);
        wake_all();
        if (worker.steps < all) {
            worker.next = &Simulation::aggregate;
        } else if (worker.group.part == 0) {
            ++worker.untold;
            worker.next = &Simulation::take;
        } else {
            worker.next = &Simulation::find_winners;
        }
        (this->*worker.next)(i);
    }

    void find_winners(std::size_t i) {
        if (groups_without_sums_ > 0) {
            waiting_.push_back(i);
            return;
        }
        workers_[i].next = &Simulation::take;
        schedule(i, times_.winners);
    }

    void tell(Worker& worker) {
        groups_without_sums_ -= worker.untold;
        worker.untold = 0;
        wake_all();
    }

    // Who cannot go on yet goes back to sleep.
    void wake_all() {
        for (const std::size_t i : waiting_) {
            schedule(i, 0);
        }
        waiting_.clear();
    }

    const Division& division_;
    const TaskTimes& times_;
    cpu::SweepScheduler::Groups groups_;
    cpu::SweepScheduler scheduler_;
    int groups_without_sums_;
    std::vector<Worker> workers_;
    std::array<std::vector<int>, 2> done_;  // positions of each group
    std::vector<std::size_t> waiting_;
    std::priority_queue<Event, std::vector<Event>, std::greater<>> events_;
    double now_ = 0;
};

}  // namespace

double simulate(const Division& division, const TaskTimes& times, int workers) {
    return Simulation(division, times, workers).run();
}

}  // namespace disparityd::schedule
