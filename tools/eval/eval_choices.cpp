// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/eval_choices.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "capture/scene/scene_source.h"
#include "tools/eval/paper.h"
#include "tools/eval/rendered_scene.h"

namespace disparityd::eval {

namespace {

/// Each once, in the order in which they were first named: a mean counts a row once more for each time it is there.
template <typename Choice>
std::vector<Choice> once(const std::vector<Choice>& named) {
    std::vector<Choice> chosen;
    for (const Choice& one : named) {
        if (std::find(chosen.begin(), chosen.end(), one) == chosen.end()) {
            chosen.push_back(one);
        }
    }
    return chosen;
}

}  // namespace

std::vector<Method> methods_of(const EvalArguments& arguments) {
    std::vector<Method> methods;
    for (const std::string& text : arguments.methods) {
        if (text == "all") {
            methods.insert(methods.end(), {Method::sad, Method::census, Method::sgm});
        } else {
            methods.push_back(tools::parse_method(text));
        }
    }
    return once(methods);
}

std::vector<const Backend*> backends_of(const EvalArguments& arguments) {
    std::vector<const Backend*> chosen;
    for (const std::string& text : arguments.backends) {
        if (text == "all") {
            for (const Backend& row : backends()) {
                if (row.available()) {
                    chosen.push_back(&row);
                }
            }
        } else {
            chosen.push_back(&backend(text));
        }
    }
    return once(chosen);
}

namespace {

std::vector<SceneToJudge> scenes_of_paper(const EvalArguments& arguments) {
    const std::vector<datasets::DatasetScene> found = find_scenes(arguments.data);
    std::vector<SceneToJudge> chosen;
    for (const PaperScene& wanted : paper_scenes()) {
        const datasets::DatasetScene* files = files_of(wanted, found);
        if (files == nullptr) {
            throw std::invalid_argument("--paper: there is no folder for the scene " + wanted.name +
                                        " in DATA, allowed: folders that hold cones, tsukuba, teddy and sawtooth");
        }
        chosen.push_back(scene_of_files(*files, wanted.disparities, arguments.scale.value_or(0)));
    }
    return chosen;
}

}  // namespace

std::vector<SceneToJudge> scenes_of(const EvalArguments& arguments) {
    if (arguments.paper) {
        return scenes_of_paper(arguments);
    }
    std::vector<SceneToJudge> chosen;
    for (const std::string& data : arguments.data) {
        if (capture::is_scene(data)) {
            const std::vector<SceneToJudge> rendered = rendered_scenes(data);
            chosen.insert(chosen.end(), rendered.begin(), rendered.end());
            continue;
        }
        for (const datasets::DatasetScene& files : find_scenes({data})) {
            chosen.push_back(scene_of_files(files, 0, arguments.scale.value_or(0)));
        }
    }
    return chosen;
}

MatchOptions options_for(const EvalArguments& arguments, Method method, int disparities) {
    MatchOptions options = arguments.match.options(method, disparities);
    if (arguments.paper) {
        options.post.subpixel = arguments.match.given("subpixel").value_or(0) != 0;
        options.post.interpolate = arguments.match.given("interpolate").value_or(1) != 0;
        options.post.min_texture = arguments.match.given("min_texture").value_or(0);
    }
    return options;
}

}  // namespace disparityd::eval
