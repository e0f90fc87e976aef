// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/paper.h"

#include <algorithm>
#include <filesystem>
#include <ostream>

#include "base/words.h"
#include "tools/command_line/table.h"
#include "tools/eval/means.h"

namespace disparityd::eval {

using base::lower_case;

namespace {

/// Adds the line of a cell, or of a mean of cells, which begins with `names`.
void add_cells(std::vector<std::string> names, double paper, double ours, double density, const std::string& ms,
               tools::Table& table) {
    const std::string difference = tools::fixed(ours - paper, 2);
    names.insert(names.end(), {tools::fixed(paper, 1), tools::fixed(ours, 2),
                               difference[0] == '-' ? difference : '+' + difference, tools::fixed(density, 1), ms});
    table.add(names);
}

}  // namespace

double PaperScene::bad(Method method) const {
    switch (method) {
        case Method::sad: return sad;
        case Method::census: return census;
        case Method::sgm: return sgm;
    }
    return 0;
}

const std::vector<PaperScene>& paper_scenes() {
    static const std::vector<PaperScene> scenes{{"Cones", 128, 18.3, 20.1, 6.9},
                                                {"Tsukuba", 32, 14.0, 12.2, 5.7},
                                                {"Teddy", 128, 16.6, 18.2, 7.1},
                                                {"Sawtooth", 32, 19.2, 20.1, 7.0}};
    return scenes;
}

const PaperScene* paper_scene(const std::string& name) {
    const std::string folder = lower_case(std::filesystem::path(name).filename().string());
    const auto& scenes = paper_scenes();
    const auto found = std::find_if(scenes.begin(), scenes.end(),
                                    [&](const PaperScene& scene) { return lower_case(scene.name) == folder; });
    return found == scenes.end() ? nullptr : &*found;
}

const datasets::DatasetScene* files_of(const PaperScene& scene, const std::vector<datasets::DatasetScene>& found) {
    const auto files = std::find_if(found.begin(), found.end(), [&](const datasets::DatasetScene& candidate) {
        const PaperScene* paper = paper_scene(candidate.name);
        return paper != nullptr && paper->name == scene.name;
    });
    return files == found.end() ? nullptr : &*files;
}

void print_paper_table(const std::vector<Row>& rows, bool markdown, std::ostream& to) {
    tools::Table table({"scene (D)", "method", "backend", "paper %", "ours %", "ours - paper", "density %", "ms"});
    Measurements measured{{{"paper %", "paper", 1}, {"ours %", "ours"}, {"density %", "density", 1}}, {}};
    int better = 0, judged = 0;
    for (const Row& row : rows) {
        const auto method = method_from_name(row.method);
        const PaperScene* scene = paper_scene(row.scene);
        if (!method || scene == nullptr) {
            continue;
        }
        const double paper = scene->bad(*method);
        const double ours = row.accuracy.bad1_nonocc;
        ++judged;
        better += ours <= paper ? 1 : 0;
        add_cells({scene->name + " (" + std::to_string(row.disparities) + ")", row.method, row.backend}, paper, ours,
                  row.accuracy.density, tools::fixed(row.ms, 1), table);
        measured.rows.push_back({row.scene, row.method, row.backend, {paper, ours, row.accuracy.density}});
    }
    for (const Mean& mean : means(measured)) {
        add_cells({"mean", mean.method, mean.backend}, mean.values[0], mean.values[1], mean.values[2], "", table);
    }
    markdown ? table.print_markdown(to) : table.print(to);
    to << '\n' << better << " of " << judged << " cells at most the paper's figure\n";
}

}  // namespace disparityd::eval
