// SPDX-License-Identifier: Apache-2.0
//
// Looks after a running engine at intervals: its memory, its load, its cores, and what comes too near.
#include "daemon/configured_source.h"
#include "daemon/engine.h"
#include "daemon/system/huge_pages.h"

namespace disparityd::daemon {

using std::chrono::steady_clock;

bool Engine::check_memory() {
    if (memory_checked_ || !started_ || pipeline_->status().published == 0) {
        return false;
    }
    memory_checked_ = true;
    const std::lock_guard lock(mutex_);
    memory_notice_ = huge_page_notice(huge_pages());
    return !memory_notice_.empty();
}

std::string Engine::check_load() {
    const auto now = steady_clock::now();
    if (!started_ || !newest_wins(config_, source().live) || !load_.is_due(now)) {
        return {};  // a status adds up all histograms
    }
    const pipeline::PipelineStatus status = pipeline_->status();
    // Damaged frames come and are not matched, which is no matter of load.
    std::string line =
        load_.check(status.published + status.dropped + status.over_budget, status.published, status.over_budget, now);
    if (!line.empty()) {
        const std::lock_guard lock(mutex_);
        load_notice_ = line;
    }
    return line;
}

bool Engine::check_cores() {
    if (!started_ || stopped_) {
        return false;
    }
    if (pipeline_->wait_until_ended(std::chrono::milliseconds(0))) {
        workers_.give_cores_back();
        return false;
    }
    return workers_.claim_cores();
}

std::string Engine::check_near() {
    return started_ ? measured_->near_line() : std::string();
}

}  // namespace disparityd::daemon
