// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "pipeline/pipeline.h"
#include "proto/disparity.pb.h"

namespace disparityd::daemon {

/// Sets the bounds and the steps of `totals` to what a pipeline has counted.
void put_steps(v1::Totals& totals, const std::vector<pipeline::PipelineStatus::Step>& steps);

/// Adds what engines before have counted to what the one in use has. Steps are the same where their names are; what
/// only `before` has is appended, so that no count ends while the daemon runs.
void add_totals(v1::Totals& totals, const v1::Totals& before);

}  // namespace disparityd::daemon
