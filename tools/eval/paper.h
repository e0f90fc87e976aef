// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "kernels/options.h"
#include "tools/datasets/dataset.h"
#include "tools/eval/report.h"

namespace disparityd::eval {

/// A scene of the paper's tables, with the bad pixels that its table 6 gives, in percent.
struct PaperScene {
    std::string name;  ///< as the paper writes it; the folder has the same name in lower case
    int disparities;
    double sad, census, sgm;

    double bad(Method method) const;
};

const std::vector<PaperScene>& paper_scenes();

/// The paper's scene of that name, as DatasetScene has it, or nullptr.
const PaperScene* paper_scene(const std::string& name);

/// The files of a scene of the paper among those that were found, or nullptr.
const datasets::DatasetScene* files_of(const PaperScene& scene, const std::vector<datasets::DatasetScene>& found);

/// Table 6: bad-1.0 over non-occluded pixels beside the paper's figures, for the rows of paper scenes, then the means
/// of each method and back end over the scenes.
void print_paper_table(const std::vector<Row>& rows, bool markdown, std::ostream& to);

}  // namespace disparityd::eval
