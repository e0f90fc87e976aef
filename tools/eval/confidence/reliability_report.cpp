// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/confidence/reliability_report.h"

#include <algorithm>
#include <ostream>

#include <nlohmann/json.hpp>

#include "tools/command_line/table.h"
#include "tools/eval/means.h"

namespace disparityd::eval {

void print_reliability(const std::vector<NamedReliability>& all, bool markdown, std::ostream& to) {
    std::vector<std::string> head{"confidence"};
    std::vector<std::vector<ReliabilityBin>> bins;
    for (const NamedReliability& one : all) {
        head.push_back(one.name + ": pixels %");
        head.push_back("says %");
        head.push_back("right %");
        bins.push_back(reliability_bins(one.counted));
    }
    tools::Table table(head);
    for (std::size_t i = 0; !bins.empty() && i < bins.front().size(); ++i) {
        if (std::none_of(bins.begin(), bins.end(), [i](const auto& of_one) { return of_one[i].share > 0; })) {
            continue;
        }
        const ReliabilityBin& bin = bins.front()[i];
        std::vector<std::string> line{std::to_string(bin.first) + " to " + std::to_string(bin.last)};
        for (const auto& of_one : bins) {
            line.push_back(figure_text(100 * of_one[i].share, 2));
            line.push_back(figure_text(100 * of_one[i].says, 1));
            line.push_back(figure_text(100 * of_one[i].is, 1));
        }
        table.add(line);
    }
    for (const auto& [title, figure] : {std::pair("calibration error, %", &calibration_error),
                                        std::pair("sparsification area, %", &sparsification_area)}) {
        std::vector<std::string> line{title};
        for (const NamedReliability& one : all) {
            line.insert(line.end(), {"", "", figure_text(100 * figure(one.counted), 2)});
        }
        table.add(line);
    }
    markdown ? table.print_markdown(to) : table.print(to);
}

nlohmann::ordered_json reliability_json(const std::vector<NamedReliability>& all) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const NamedReliability& one : all) {
        list.push_back({{"name", one.name},
                        {"calibration_error", calibration_error(one.counted)},
                        {"sparsification_area", sparsification_area(one.counted)},
                        {"weight", one.counted.weight},
                        {"right", one.counted.right}});
    }
    return list;
}

}  // namespace disparityd::eval
