// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/benchmark/sparsification_chart.h"

#include <algorithm>

#include "base/number_text.h"

namespace disparityd::eval {
namespace {

constexpr double width = 360, height = 210, left = 52, right = 350, top = 12, bottom = 168;

/// Where the curves lie in the chart.
struct ChartScale {
    double largest = 0;  ///< error at the upper edge, px, more than 0

    static std::string x(double removed_percent) {
        return base::fixed(left + (right - left) * removed_percent / 100, 1);
    }
    std::string y(double error) const { return base::fixed(bottom - (bottom - top) * error / largest, 1); }
};

std::string line_of(const std::array<double, Sparsification::steps>& curve, const ChartScale& scale,
                    const char* colour) {
    std::string points;
    for (std::size_t step = 0; step < curve.size(); ++step) {
        points += ChartScale::x(static_cast<double>(step)) + ',' + scale.y(curve[step]) + ' ';
    }
    return "<polyline fill=\"none\" stroke-width=\"2\" stroke=\"" + std::string(colour) + "\" points=\"" + points +
           "\"/>\n";
}

std::string text_at(const std::string& x, const std::string& y, const char* anchor, const std::string& text) {
    return "<text x=\"" + x + "\" y=\"" + y + "\" text-anchor=\"" + anchor + "\">" + text + "</text>\n";
}

}  // namespace

std::string sparsification_chart(const Sparsification& curves) {
    const double largest = *std::max_element(curves.error_px.begin(), curves.error_px.end());
    const ChartScale scale{largest > 0 ? largest : 1};
    std::string svg =
        "<svg viewBox=\"0 0 " + base::fixed(width, 0) + ' ' + base::fixed(height, 0) +
        "\" role=\"img\" font-size=\"12\" fill=\"currentColor\"><title>mean error of what is left</title>\n";
    for (const double share : {0.0, 0.5, 1.0}) {
        const std::string y = scale.y(share * scale.largest);
        svg += "<line stroke=\"currentColor\" opacity=\".25\" x1=\"" + base::fixed(left, 1) + "\" x2=\"" +
               base::fixed(right, 1) + "\" y1=\"" + y + "\" y2=\"" + y + "\"/>\n";
        svg += text_at(base::fixed(left - 6, 1), y, "end", base::fixed(share * scale.largest, 2));
    }
    for (const double percent : {0.0, 50.0, 100.0}) {
        svg += text_at(ChartScale::x(percent), base::fixed(bottom + 16, 1), "middle", base::fixed(percent, 0));
    }
    svg += line_of(curves.best_px, scale, "#8a929c") + line_of(curves.error_px, scale, "#2f74d0");
    svg += text_at(ChartScale::x(50), base::fixed(height - 6, 0), "middle", "percent removed");
    return svg + "</svg>\n";
}

}  // namespace disparityd::eval
