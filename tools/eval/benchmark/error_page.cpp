// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/benchmark/error_page.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <initializer_list>

#include <nlohmann/json.hpp>

#include "tools/eval/benchmark/sparsification_chart.h"
#include "tools/eval/means.h"
#include "tools/eval/pictures/error_picture.h"
#include "tools/images/image_file.h"
#include "tools/images/picture.h"

namespace disparityd::eval {
namespace {

constexpr const char* page_begin = R"html(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Disparity errors</title>
<style>
body { font: 15px/1.4 system-ui, sans-serif; margin: 1.5rem; background: #f6f7f8; color: #17191c; }
header, article { background: #fff; border: 1px solid #d5d9de; border-radius: 6px; padding: .8rem 1rem; margin-bottom: 1rem; }
h1 { font-size: 1.3rem; margin: 0 0 .5rem; } h2 { font-size: 1.05rem; margin: 0 0 .5rem; overflow-wrap: anywhere; }
h2 small { color: #5a626c; font-weight: normal; }
label { margin-right: 1rem; white-space: nowrap; } select { font: inherit; }
.legend span { display: inline-block; margin-right: 1rem; white-space: nowrap; }
.legend i { display: inline-block; width: 1em; height: 1em; border: 1px solid #888; vertical-align: -.15em; margin-right: .35em; }
.pictures { display: grid; grid-template-columns: repeat(auto-fit, minmax(280px, 1fr)); gap: .5rem; }
figure { margin: 0; } figcaption { color: #5a626c; font-size: .85rem; }
img { width: 100%; height: auto; display: block; background: #ddd; }
.figures { overflow-x: auto; margin-top: .5rem; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: .8rem; }
summary { cursor: pointer; } .chart { max-width: 30rem; }
th, td { padding: .15rem .45rem; text-align: right; border-bottom: 1px solid #e6e8eb; white-space: nowrap; }
th:first-child, td:first-child, .means th:nth-child(-n+3), .means td:nth-child(-n+3) { text-align: left; }
td.chosen { background: #fff3c4; font-weight: 600; }
@media (prefers-color-scheme: dark) {
  body { background: #15171a; color: #e8eaed; } header, article { background: #1e2125; border-color: #3a4047; }
  h2 small, figcaption { color: #a4acb6; } th, td { border-color: #343a41; } td.chosen { background: #5a4a10; }
}
</style>
</head>
<body>
)html";

// The order of the elements in the file is the first choice, so that the page serves without scripts, too.
constexpr const char* page_end = R"html(</main>
<script>
"use strict";
const results = JSON.parse(document.getElementById("results").textContent);
const list = document.getElementById("list");
const choice = name => document.getElementById(name);
function show() {
  const region = choice("region").value, figure = Number(choice("figure").value), matcher = choice("matcher").value;
  const order = choice("order").value === "worst" ? -1 : 1;
  const valueOf = result => region in result.regions ? result.regions[region][figure] : null;
  const sorted = [...results].sort((a, b) => {
    const x = valueOf(a), y = valueOf(b);
    return x === null ? (y === null ? 0 : 1) : y === null ? -1 : order * (x - y);
  });
  for (const result of sorted) {
    const entry = document.getElementById("result-" + result.number);
    entry.hidden = matcher !== "" && matcher !== result.matcher;
    list.append(entry);
  }
  for (const cell of document.querySelectorAll("td[data-figure]")) {
    cell.classList.toggle("chosen", cell.dataset.region === region && Number(cell.dataset.figure) === figure);
  }
}
for (const name of ["region", "figure", "matcher", "order"]) {
  choice(name).addEventListener("change", show);
}
show();
</script>
</body>
</html>
)html";

std::string escaped(const std::string& text) {
    std::string safe;
    for (const char letter : text) {
        switch (letter) {
            case '&': safe += "&amp;"; break;
            case '<': safe += "&lt;"; break;
            case '>': safe += "&gt;"; break;
            case '"': safe += "&quot;"; break;
            default: safe += letter;
        }
    }
    return safe;
}

constexpr std::size_t first_figure = 2;  // bad-1.0

/// What the page is sorted by at first; unknown is last.
double first_value(const std::vector<BenchmarkCell>& cells) {
    const double value = cells.empty() ? std::nan("") : values_of(cells.front().tally)[first_figure];
    return std::isnan(value) ? -1 : value;
}

std::string picture_name(std::size_t number, const char* what) {
    std::array<char, 48> name{};
    std::snprintf(name.data(), name.size(), "%05zu_%s.png", number, what);
    return name.data();
}

/// From 0, or less where the truth goes there, to the largest true disparity: one scale for all matchers of a scene.
images::ColourScale scale_of_truth(const images::FloatMap& truth) {
    images::ColourScale scale{0, 1};
    for (const float value : truth.values) {
        if (std::isfinite(value)) {
            scale.low = std::min(scale.low, static_cast<double>(value));
            scale.high = std::max(scale.high, static_cast<double>(value));
        }
    }
    return scale;
}

std::string legend_html() {
    std::string html = "<p class=\"legend\">";
    for (const images::LegendRow& row : error_colours()) {
        std::array<char, 8> colour{};
        std::snprintf(colour.data(), colour.size(), "#%02x%02x%02x", row.colour[2], row.colour[1], row.colour[0]);
        html +=
            "<span><i style=\"background:" + std::string(colour.data()) + "\"></i>" + escaped(row.meaning) + "</span>";
    }
    return html + "</p>\n";
}

std::string choice_html(const std::string& id, const std::string& label,
                        const std::vector<std::pair<std::string, std::string>>& choices) {
    std::string html = "<label>" + label + " <select id=\"" + id + "\">";
    for (const auto& [value, text] : choices) {
        html += "<option value=\"" + escaped(value) + "\">" + escaped(text) + "</option>";
    }
    return html + "</select></label>\n";
}

/// What can be sorted by; bad-1.0 first, as the page begins with it.
std::vector<std::pair<std::string, std::string>> figure_choices() {
    const std::vector<Figure> figures = benchmark_figures();
    std::vector<std::pair<std::string, std::string>> choices{
        {std::to_string(first_figure), figures[first_figure].heading}};
    for (std::size_t i = 0; i < figures.size(); ++i) {
        if (i != first_figure) {
            choices.emplace_back(std::to_string(i), figures[i].heading);
        }
    }
    return choices;
}

std::string heads_html(std::initializer_list<const char*> first) {
    std::string html = "<div class=\"figures\"><table><tr>";
    for (const char* head : first) {
        html += std::string("<th>") + head + "</th>";
    }
    for (const Figure& figure : benchmark_figures()) {
        html += "<th>" + figure.heading + "</th>";
    }
    return html + "</tr>\n";
}

std::string values_html(const std::vector<double>& values, Region region) {
    const std::vector<Figure> figures = benchmark_figures();
    std::string html;
    for (std::size_t i = 0; i < figures.size(); ++i) {
        html += "<td data-region=\"" + std::string(name(region)) + "\" data-figure=\"" + std::to_string(i) + "\">" +
                figure_text(values[i], figures[i].decimals) + "</td>";
    }
    return html + "</tr>\n";
}

std::string figures_html(const std::vector<BenchmarkCell>& cells) {
    std::string html = heads_html({"region", "pixels"});
    for (const BenchmarkCell& cell : cells) {
        html += "<tr><td>" + std::string(name(cell.region)) + "</td><td>" + std::to_string(cell.tally.pixels) +
                "</td>" + values_html(values_of(cell.tally), cell.region);
    }
    return html + "</table></div>\n";
}

std::string means_html(const std::vector<BenchmarkCell>& cells) {
    std::string html = "<details open class=\"means\"><summary>means</summary>\n" +
                       heads_html({"matcher", "region", "of", "scenes", "pixels"});
    for (const BenchmarkRow& row : rows_of(cells)) {
        if (row.kind != RowKind::scene) {
            html += "<tr><td>" + escaped(row.matcher) + "</td><td>" + std::string(name(row.region)) + "</td><td>" +
                    std::string(name(row.kind)) + "</td><td>" + std::to_string(row.scenes) + "</td><td>" +
                    std::to_string(row.pixels) + "</td>" + values_html(row.values, row.region);
        }
    }
    return html + "</table></div></details>\n";
}

std::string image_html(const std::string& file, const std::string& caption) {
    return "<figure><a href=\"" + file + "\"><img loading=\"lazy\" src=\"" + file + "\" alt=\"" + caption +
           "\"></a><figcaption>" + caption + "</figcaption></figure>\n";
}

/// The curves of the first region, which the page is sorted by at first; nothing without confidences.
std::string chart_html(const std::vector<BenchmarkCell>& cells) {
    if (cells.empty() || !cells.front().tally.curves) {
        return {};
    }
    return "<details><summary>sparsification</summary><figure class=\"chart\">" +
           sparsification_chart(*cells.front().tally.curves) + "<figcaption>" +
           std::string(name(cells.front().region)) +
           ": mean error, px, of what is left when the least confident pixels are removed (blue), and when those of "
           "the "
           "largest error are (grey)</figcaption></figure></details>\n";
}

/// JSON that may stand in a script element.
std::string script_text(const nlohmann::ordered_json& json) {
    std::string safe;
    for (const char letter : json.dump(-1, ' ', true, nlohmann::ordered_json::error_handler_t::replace)) {
        safe += letter == '<' ? "\\u003c" : std::string(1, letter);
    }
    return safe;
}

}  // namespace

void ErrorPage::add(const Scene& scene, const images::FloatMap& disparity, const std::vector<BenchmarkCell>& cells) {
    const std::size_t number = entries_.size() + 1;
    Entry entry{
        scene.name, cells.front().matcher, "", picture_name(number, "disparity"), picture_name(number, "errors"),
        cells};
    const bool is_new_scene = entries_.empty() || entries_.back().scene != scene.name;
    entry.left = is_new_scene ? picture_name(number, "left") : entries_.back().left;
    if (is_new_scene) {
        images::write_png(folder_ + '/' + entry.left, scene.left);
    }
    images::write_png(folder_ + '/' + entry.disparity,
                      images::colour_disparity(disparity, scale_of_truth(scene.truth)));
    images::write_png(folder_ + '/' + entry.errors, error_image(scene, disparity));
    entries_.push_back(std::move(entry));
}

std::string ErrorPage::entry_html(const Entry& entry, std::size_t number) const {
    return "<article id=\"result-" + std::to_string(number) + "\">\n<h2>" + escaped(entry.scene) + " <small>" +
           escaped(entry.matcher) + "</small></h2>\n<div class=\"pictures\">\n" + image_html(entry.left, "left image") +
           image_html(entry.disparity, "disparity") + image_html(entry.errors, "errors") + "</div>\n" +
           figures_html(entry.cells) + chart_html(entry.cells) + "</article>\n";
}

void ErrorPage::write(Holes holes) const {
    if (entries_.empty()) {
        return;
    }
    std::vector<std::size_t> order;
    std::vector<std::pair<std::string, std::string>> regions, matchers{{"", "all"}};
    auto results = nlohmann::ordered_json::array();
    const auto add_once = [](auto& choices, const std::string& choice) {
        if (std::find(choices.begin(), choices.end(), std::pair(choice, choice)) == choices.end()) {
            choices.emplace_back(choice, choice);
        }
    };
    for (std::size_t i = 0; i < entries_.size(); ++i) {
        order.push_back(i);
        add_once(matchers, entries_[i].matcher);
        auto values = nlohmann::ordered_json::object();
        for (const BenchmarkCell& cell : entries_[i].cells) {
            add_once(regions, std::string(name(cell.region)));
            auto numbers = nlohmann::ordered_json::array();
            for (const double value : values_of(cell.tally)) {
                numbers.push_back(rounded_number(value));
            }
            values[std::string(name(cell.region))] = numbers;
        }
        results.push_back({{"number", i + 1}, {"matcher", entries_[i].matcher}, {"regions", values}});
    }
    std::stable_sort(order.begin(), order.end(), [this](std::size_t a, std::size_t b) {
        return first_value(entries_[a].cells) > first_value(entries_[b].cells);
    });
    std::vector<BenchmarkCell> cells;
    for (const Entry& entry : entries_) {
        cells.insert(cells.end(), entry.cells.begin(), entry.cells.end());
    }
    std::string html = page_begin;
    html += "<header>\n<h1>Disparity errors</h1>\n";
    html += legend_html();
    html += choice_html("figure", "sort by", figure_choices()) + choice_html("region", "of", regions) +
            choice_html("order", "", {{"worst", "largest first"}, {"best", "smallest first"}}) +
            choice_html("matcher", "matcher", matchers);
    html += std::string("<p>Pixels without a disparity ") +
            (holes == Holes::bad        ? "count as bad in bad-x and D1"
             : holes == Holes::left_out ? "are left out"
                                        : "were filled as KITTI fills them") +
            ". avg, RMS and A50 to A99 are errors of the pixels that have one.</p>\n";
    html += means_html(cells) + "</header>\n<script type=\"application/json\" id=\"results\">" + script_text(results) +
            "</script>\n";
    html += "<main id=\"list\">\n";
    for (const std::size_t i : order) {
        html += entry_html(entries_[i], i + 1);
    }
    html += page_end;
    images::write_file(folder_ + "/index.html", html);
}

}  // namespace disparityd::eval
