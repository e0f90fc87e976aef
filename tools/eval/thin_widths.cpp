// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/thin_widths.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tools/command_line/table.h"

namespace disparityd::eval {
namespace {

/// The pixels of poles and wires, and how far each of them goes on.
class Runs {
public:
    Runs(const images::FloatMap& truth, const std::vector<std::uint8_t>& thin) : truth_(truth), thin_(thin) {}

    bool has(int x, int y) const {
        return x >= 0 && y >= 0 && x < truth_.width && y < truth_.height &&
               thin_[static_cast<std::size_t>(y) * static_cast<std::size_t>(truth_.width) +
                     static_cast<std::size_t>(x)] != 0 &&
               std::isfinite(truth_.at(x, y));
    }

    /// Along the row or the column: (1, 0) or (0, 1).
    int length(int x, int y, int dx, int dy) const { return 1 + reach(x, y, dx, dy) + reach(x, y, -dx, -dy); }

private:
    int reach(int x, int y, int dx, int dy) const {
        int steps = 0;
        while (has(x + dx, y + dy) && std::abs(truth_.at(x + dx, y + dy) - truth_.at(x, y)) < 1.0F) {
            x += dx;
            y += dy;
            ++steps;
        }
        return steps;
    }

    const images::FloatMap& truth_;
    const std::vector<std::uint8_t>& thin_;
};

}  // namespace

void ThinWidths::add(const images::FloatMap& disparity, const images::FloatMap& truth,
                     const std::vector<std::uint8_t>& thin) {
    if (disparity.width != truth.width || disparity.height != truth.height || thin.size() != truth.values.size()) {
        throw std::invalid_argument("disparity, ground truth and the mask of thin things differ in size");
    }
    const Runs runs(truth, thin);
    for (int y = 0; y < truth.height; ++y) {
        for (int x = 0; x < truth.width; ++x) {
            if (!runs.has(x, y)) {
                continue;
            }
            const int width = std::min(runs.length(x, y, 1, 0), runs.length(x, y, 0, 1));
            Count& count = counts_[static_cast<std::size_t>(width <= widest ? width : 0)];
            ++count.pixels;
            // Rejected pixels are not finite, and so no difference of them is small.
            count.found += std::abs(disparity.at(x, y) - truth.at(x, y)) <= 1.0F ? 1U : 0U;
        }
    }
}

void print_thin_widths(const std::vector<NamedThinWidths>& all, bool markdown, std::ostream& out) {
    std::vector<std::string> head{"width px", "pixels"};
    for (const NamedThinWidths& one : all) {
        head.push_back(one.name + " found %");
    }
    tools::Table table(head);
    for (int i = 1; i <= ThinWidths::widest + 1; ++i) {
        const int width = i % (ThinWidths::widest + 1);
        if (all.empty() || all.front().widths.of(width).pixels == 0) {
            continue;
        }
        std::vector<std::string> line{width == 0 ? "more" : std::to_string(width),
                                      std::to_string(all.front().widths.of(width).pixels)};
        for (const NamedThinWidths& one : all) {
            const ThinWidths::Count& count = one.widths.of(width);
            line.push_back(
                tools::fixed(100.0 * static_cast<double>(count.found) / static_cast<double>(count.pixels), 1));
        }
        table.add(line);
    }
    markdown ? table.print_markdown(out) : table.print(out);
}

nlohmann::ordered_json thin_widths_json(const std::vector<NamedThinWidths>& all) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const NamedThinWidths& one : all) {
        for (int width = 0; width <= ThinWidths::widest; ++width) {
            const ThinWidths::Count& count = one.widths.of(width);
            if (count.pixels > 0) {
                list.push_back(
                    {{"name", one.name}, {"width", width}, {"pixels", count.pixels}, {"found", count.found}});
            }
        }
    }
    return list;
}

}  // namespace disparityd::eval
