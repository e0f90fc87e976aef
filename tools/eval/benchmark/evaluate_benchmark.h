// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/eval/eval_arguments.h"

namespace disparityd::eval {

/// Does what `disparity-eval --benchmark` does: judges files of other programs where --results names them, and matchers
/// that run here where it does not, or where --method or --opencv asks for them. Prints on stdout. Throws as
/// run_benchmark() does, and std::invalid_argument for arguments that do not fit together.
void evaluate_benchmark(EvalArguments arguments);

}  // namespace disparityd::eval
