// SPDX-License-Identifier: Apache-2.0
#include "pipeline/core_budget.h"

#include <algorithm>
#include <ctime>
#include <utility>

namespace disparityd::pipeline {
namespace {

/// After so long without a frame that asks, none is compared with what was spent: nobody wanted any.
constexpr CoreBudget::Seconds pause = CoreBudget::window;

constexpr CoreBudget::Seconds second{1};

CoreBudget::Moment moment_of_process() {
    return {std::chrono::steady_clock::now(), processor_time()};
}

}  // namespace

std::chrono::nanoseconds processor_time() {
    timespec used{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &used);
    return std::chrono::seconds(used.tv_sec) + std::chrono::nanoseconds(used.tv_nsec);
}

CoreBudget::CoreBudget(double cores, Clock clock)
    : cores_(cores), clock_(clock ? std::move(clock) : Clock(moment_of_process)) {}

bool CoreBudget::admits() {
    look_at(clock_());
    if (credit_ < cost_) {
        return false;
    }
    credit_ -= cost_;
    charged_ += cost_;
    ++admitted_;
    return true;
}

CoreBudget::Seconds CoreBudget::to_wait() const {
    return Seconds(std::max(0.0, cost_ - credit_) / cores_);
}

/// Adds what the time since the last call brings.
void CoreBudget::look_at(const Moment& now) {
    if (!begun_ || now.time - last_ > pause) {
        begun_ = true;
        last_ = now.time;
        credit_ = cost_;
        begin_second(now);
        return;
    }
    const double earned = cores_ * Seconds(now.time - last_).count();
    const double saved = std::min(excess_, earned / 2);
    last_ = now.time;
    excess_ -= saved;
    credit_ += earned - saved;
    if (now.time - second_.time >= second && admitted_ > 0) {
        close_second(now);
    }
    // Two frames' worth at most: frames that come late are made up for, a pause is not.
    const double beyond = std::max(0.0, credit_ - 2 * cost_);
    credit_ -= beyond;
    unused_ += beyond;
}

void CoreBudget::close_second(const Moment& now) {
    const double spent = (now.used - second_.used).count();
    const double of_frame = spent / admitted_;
    cost_ = std::min(next_cost(of_frame), cores_ * Seconds(most_of_frame).count());
    const double uncharged = spent - charged_;
    excess_ += uncharged > 0 ? std::max(0.0, uncharged - unused_) : uncharged;
    if (excess_ < 0) {
        credit_ -= excess_;
        excess_ = 0;
    }
    // What lies further back than the average looks is forgotten.
    excess_ = std::min(excess_, cores_ * Seconds(window).count());
    begin_second(now);
}

void CoreBudget::begin_second(const Moment& now) {
    second_ = now;
    charged_ = 0;
    admitted_ = 0;
    unused_ = 0;
    const std::lock_guard lock(mutex_);
    moments_[count_ % kept] = now;
    ++count_;
}

/// Returns the average after `of_frame`. Where the last frames cost less than half, other work has ended: the average
/// follows faster, so that frames are soon as many as before. It does not jump: what is still in flight is not in it.
double CoreBudget::next_cost(double of_frame) const {
    if (cost_ == 0) {
        return of_frame;
    }
    const double followed = of_frame < cost_ / 2 ? 2 : 4;
    return cost_ + (of_frame - cost_) / followed;
}

double CoreBudget::used() const {
    const Moment now = clock_();
    const std::lock_guard lock(mutex_);
    if (count_ == 0) {
        return 0;
    }
    Moment from = moments_[(count_ - 1) % kept];
    for (std::size_t back = 2; back <= std::min(count_, kept); ++back) {
        const Moment& earlier = moments_[(count_ - back) % kept];
        if (now.time - earlier.time > window) {
            break;
        }
        from = earlier;
    }
    const Seconds passed = now.time - from.time;
    return passed.count() > 0 ? (now.used - from.used).count() / passed.count() : 0;
}

}  // namespace disparityd::pipeline
