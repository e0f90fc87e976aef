// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kernels/matcher.h"
#include "kernels/options.h"
#include "tools/eval/eval_arguments.h"
#include "tools/eval/scene.h"

namespace disparityd::eval {

/// What the arguments of the command line name. Each throws std::invalid_argument with one line for a name or a folder
/// that is none. A method or backend that is named twice is there once.
std::vector<Method> methods_of(const EvalArguments& arguments);
std::vector<const Backend*> backends_of(const EvalArguments& arguments);
std::vector<SceneToJudge> scenes_of(const EvalArguments& arguments);

/// The tuned settings of a method; the paper has whole pixels, no test for texture, and judges every pixel.
MatchOptions options_for(const EvalArguments& arguments, Method method, int disparities);

}  // namespace disparityd::eval
