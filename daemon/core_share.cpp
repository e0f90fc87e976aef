// SPDX-License-Identifier: Apache-2.0
#include "daemon/core_share.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/words.h"
#include "pipeline/core_budget.h"
#include "pipeline/cores.h"

namespace disparityd::daemon {

int configured_workers(const Config& config) {
    if (config.pipeline.workers > 0 || !config.pipeline.cores) {
        return config.pipeline.workers;
    }
    return std::min(static_cast<int>(std::ceil(*config.pipeline.cores)), pipeline::cores_worth());
}

std::string core_share_note(const Config& config, int workers, bool live) {
    if (!config.pipeline.cores) {
        return {};
    }
    const double cores = *config.pipeline.cores;
    const int here = pipeline::cores_worth();
    const std::string limit =
        cores >= here ? fmt::format("no less than the {} here", base::counted(static_cast<std::uint64_t>(here), "core"))
                      : fmt::format("at most that much processor time of the whole process, on average over {} s",
                                    pipeline::CoreBudget::window.count());
    return fmt::format("[pipeline] cores = {}: {}; {}; {}", cores, limit,
                       base::counted(static_cast<std::uint64_t>(workers), "worker"),
                       live ? "frames beyond it are left out, evenly" : "a replay is slowed, no frame is left out");
}

}  // namespace disparityd::daemon
