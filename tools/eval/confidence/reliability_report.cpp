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
        head.push_back("sigma px");
        bins.push_back(reliability_bins(one.counted));
    }
    tools::Table table(head);
    for (std::size_t i = 0; !bins.empty() && i < bins.front().size(); ++i) {
        if (std::none_of(bins.begin(), bins.end(), [i](const auto& of_one) { return of_one[i].share > 0; })) {
            continue;
        }
        const ReliabilityBin& bin = bins.front()[i];
        std::vector<std::string> line{std::to_string(bin.first) + " to " + std::to_string(bin.last)};
        for (std::size_t one = 0; one < all.size(); ++one) {
            line.push_back(figure_text(100 * bins[one][i].share, 2));
            line.push_back(figure_text(100 * bins[one][i].says, 1));
            line.push_back(figure_text(100 * bins[one][i].is, 1));
            line.push_back(figure_text(all[one].errors.sigma_px(i), 3));
        }
        table.add(line);
    }
    for (const auto& [title, figure] : {std::pair("calibration error, %", &calibration_error),
                                        std::pair("sparsification area, %", &sparsification_area)}) {
        std::vector<std::string> line{title};
        for (const NamedReliability& one : all) {
            line.insert(line.end(), {"", "", figure_text(100 * figure(one.counted), 2), ""});
        }
        table.add(line);
    }
    std::vector<std::string> sigma{"sigma of all, px"};
    std::vector<std::string> of_68{"68.3 % are off by at most, px"};
    std::vector<std::string> of_95{"95.4 % are off by at most, px"};
    for (const NamedReliability& one : all) {
        sigma.insert(sigma.end(), {"", "", "", figure_text(one.errors.sigma_px(), 3)});
        of_68.insert(of_68.end(), {"", "", "", figure_text(one.errors.quantile_px(0.683), 3)});
        of_95.insert(of_95.end(), {"", "", "", figure_text(one.errors.quantile_px(0.954), 3)});
    }
    table.add(sigma);
    table.add(of_68);
    table.add(of_95);
    markdown ? table.print_markdown(to) : table.print(to);
}

nlohmann::ordered_json reliability_json(const std::vector<NamedReliability>& all) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const NamedReliability& one : all) {
        auto sigmas = nlohmann::ordered_json::array();
        for (std::size_t bin = 0; bin < ErrorSpread::bin_count; ++bin) {
            sigmas.push_back(rounded_number(one.errors.sigma_px(bin)));
        }
        list.push_back({{"name", one.name},
                        {"calibration_error", calibration_error(one.counted)},
                        {"sparsification_area", sparsification_area(one.counted)},
                        {"sigma_px", rounded_number(one.errors.sigma_px())},
                        {"sigma_px_of_bins", sigmas},
                        {"weight", one.counted.weight},
                        {"right", one.counted.right}});
    }
    return list;
}

}  // namespace disparityd::eval
