// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/summary.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <ostream>
#include <string>

#include <nlohmann/json.hpp>

#include "base/number_text.h"
#include "tools/command_line/table.h"
#include "tools/eval/means.h"

namespace disparityd::eval {
namespace {

constexpr std::array sides{true, false};  // the halves: a, b

const std::vector<std::string>& names_of(const Halves& halves, bool a) {
    return a ? halves.a : halves.b;
}

std::vector<Mean> means_of_half(const Summary& summary, bool a) {
    return means(summary.measured, [&](const std::string& scene) { return summary.halves->in_a(scene) == a; });
}

/// Returns the comparisons of the scenes of one half.
Wins wins_of_half(const Wins& all, const Halves& halves, bool a) {
    Wins half{all.method, all.backend, {}};
    std::copy_if(all.scenes.begin(), all.scenes.end(), std::back_inserter(half.scenes),
                 [&](const Comparison& one) { return halves.in_a(one.scene) == a; });
    return half;
}

std::size_t count_won(const Wins& wins) {
    return static_cast<std::size_t>(
        std::count_if(wins.scenes.begin(), wins.scenes.end(), [](const Comparison& one) { return one.won(); }));
}

double mean_over_scenes(const Wins& wins, double Comparison::*value) {
    double sum = wins.scenes.empty() ? std::numeric_limits<double>::quiet_NaN() : 0;
    for (const Comparison& one : wins.scenes) {
        sum += one.*value / static_cast<double>(wins.scenes.size());
    }
    return sum;
}

std::string won_text(const Wins& wins) {
    return std::to_string(count_won(wins)) + " of " + std::to_string(wins.scenes.size());
}

/// Returns the scenes that are lost and by how much; empty when there is none.
std::string lost_text(const Wins& wins) {
    std::string text;
    for (const Comparison& one : wins.scenes) {
        if (!one.won()) {
            text += (text.empty() ? "" : ", ") + one.scene + " +" + tools::fixed(one.ours - one.opencv, 2);
        }
    }
    return text;
}

std::string joined(const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& name : names) {
        text += (text.empty() ? "" : ", ") + name;
    }
    return text;
}

void print_as_asked(const tools::Table& table, bool markdown, std::ostream& to) {
    markdown ? table.print_markdown(to) : table.print(to);
}

void print_wins(const Summary& summary, bool markdown, std::ostream& to) {
    if (summary.wins->empty()) {
        to << "\nscenes won: none is compared, because no scene tells which pixels both cameras see\n";
        return;
    }
    to << "\nscenes won: bad-1.0 nonocc at most the best of OpenCV on even terms (--fair), every pixel judged\n";
    to << (markdown ? "\n" : "");
    std::vector<std::string> head{"method", "backend", "won"};
    if (summary.halves) {
        head.insert(head.end(), {"won of A", "won of B"});
    }
    head.insert(head.end(), {"ours, mean %", "best of OpenCV, mean %"});
    tools::Table table(head);
    for (const Wins& one : *summary.wins) {
        std::vector<std::string> line{one.method, one.backend, won_text(one)};
        if (summary.halves) {
            for (const bool a : sides) {
                line.push_back(won_text(wins_of_half(one, *summary.halves, a)));
            }
        }
        line.push_back(figure_text(mean_over_scenes(one, &Comparison::ours), 2));
        line.push_back(figure_text(mean_over_scenes(one, &Comparison::opencv), 2));
        table.add(line);
    }
    print_as_asked(table, markdown, to);
    for (const Wins& one : *summary.wins) {
        if (const std::string lost = lost_text(one); !lost.empty()) {
            to << (markdown ? "\n" : "") << "- lost, " << one.method << ' ' << one.backend << ": " << lost << '\n';
        }
    }
}

/// Adds a line for each matcher; each cell has the mean of both halves, first that of the half to tune on.
void add_way(const std::string& way, const std::vector<Mean>& tune, const std::vector<Mean>& judge,
             const std::vector<Figure>& figures, tools::Table& table) {
    for (std::size_t i = 0; i < tune.size(); ++i) {
        std::vector<std::string> line{way, tune[i].method, tune[i].backend};
        for (std::size_t k = 0; k < figures.size(); ++k) {
            line.push_back(figure_text(tune[i].values[k], figures[k].decimals) + " / " +
                           figure_text(judge[i].values[k], figures[k].decimals));
        }
        table.add(line);
    }
}

void print_halves(const Summary& summary, bool markdown, std::ostream& to) {
    const Halves& halves = *summary.halves;
    to << "\nhalves of seed " << halves.seed << ":\n" << (markdown ? "\n" : "");
    for (const bool a : sides) {
        const std::vector<std::string>& names = names_of(halves, a);
        to << (a ? "- A, " : "- B, ") << names.size() << (names.size() == 1 ? " scene: " : " scenes: ") << joined(names)
           << '\n';
    }
    to << "\nmeans, each way: of the half to tune on / of the half to judge on\n" << (markdown ? "\n" : "");
    std::vector<std::string> head{"tune / judge on", "method", "backend"};
    for (const Figure& figure : summary.measured.figures) {
        head.push_back(figure.heading);
    }
    tools::Table table(head);
    const std::vector<Mean> a = means_of_half(summary, true);
    const std::vector<Mean> b = means_of_half(summary, false);
    add_way("A / B", a, b, summary.measured.figures, table);
    add_way("B / A", b, a, summary.measured.figures, table);
    print_as_asked(table, markdown, to);
}

nlohmann::ordered_json won_json(const std::vector<Wins>& wins) {
    auto list = nlohmann::ordered_json::array();
    for (const Wins& one : wins) {
        auto lost = nlohmann::ordered_json::array();
        for (const Comparison& scene : one.scenes) {
            if (!scene.won()) {
                lost.push_back(scene.scene);
            }
        }
        list.push_back({{"method", one.method},
                        {"backend", one.backend},
                        {"scenes", one.scenes.size()},
                        {"won", count_won(one)},
                        {"bad1_nonocc", rounded_number(mean_over_scenes(one, &Comparison::ours))},
                        {"opencv_bad1_nonocc", rounded_number(mean_over_scenes(one, &Comparison::opencv))},
                        {"lost", lost}});
    }
    return list;
}

nlohmann::ordered_json half_json(const Summary& summary, bool a) {
    nlohmann::ordered_json half{{"scenes", names_of(*summary.halves, a)},
                                {"means", means_json(means_of_half(summary, a), summary.measured.figures)},
                                {"won", nullptr}};
    if (summary.wins) {
        std::vector<Wins> of_half;
        std::transform(summary.wins->begin(), summary.wins->end(), std::back_inserter(of_half),
                       [&](const Wins& all) { return wins_of_half(all, *summary.halves, a); });
        half["won"] = won_json(of_half);
    }
    return half;
}

}  // namespace

void print_means(const Measurements& measured, bool markdown, std::ostream& to) {
    std::vector<std::string> head{"mean of", "backend"};
    for (const Figure& figure : measured.figures) {
        head.push_back(figure.heading);
    }
    tools::Table table(head);
    for (const Mean& mean : means(measured)) {
        std::vector<std::string> line{mean.method, mean.backend};
        append_figures(mean.values, measured.figures, line);
        table.add(line);
    }
    print_as_asked(table, markdown, to);
}

void print_summary(const Summary& summary, bool markdown, std::ostream& to) {
    if (summary.wins) {
        print_wins(summary, markdown, to);
    }
    if (summary.halves) {
        print_halves(summary, markdown, to);
    }
    if (summary.noise) {
        to << "\nnoise of " << base::number_text(*summary.noise) << " grey levels (sigma) added to both images\n";
    }
}

nlohmann::ordered_json summary_json(const Summary& summary) {
    nlohmann::ordered_json object{{"means", means_json(means(summary.measured), summary.measured.figures)},
                                  {"won", nullptr},
                                  {"halves", nullptr},
                                  {"noise", nullptr}};
    if (summary.wins) {
        object["won"] = won_json(*summary.wins);
    }
    if (summary.halves) {
        object["halves"] = {
            {"seed", summary.halves->seed}, {"a", half_json(summary, true)}, {"b", half_json(summary, false)}};
    }
    if (summary.noise) {
        object["noise"] = *summary.noise;
    }
    return object;
}

}  // namespace disparityd::eval
