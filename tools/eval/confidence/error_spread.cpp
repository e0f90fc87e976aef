// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/confidence/error_spread.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <stdexcept>

namespace disparityd::eval {
namespace {

/// Of a normal distribution: the standard deviation, divided by the median of the absolute values.
constexpr double sigma_of_median = 1.4826;
constexpr double cells_per_px = 16;

}  // namespace

void ErrorSpread::add(const images::FloatMap& disparity, const std::vector<std::uint8_t>& confidence,
                      const images::FloatMap& truth) {
    if (disparity.values.size() != truth.values.size() || confidence.size() != truth.values.size()) {
        throw std::invalid_argument("confidence, disparity and truth differ in size");
    }
    std::array<Cells, bin_count> counted{};
    double pixels = 0;
    for (std::size_t i = 0; i < confidence.size(); ++i) {
        const double error = std::abs(disparity.values[i] - truth.values[i]);
        if (confidence[i] != 0 && error < 1) {  // NaN and infinite ones are not
            counted[confidence[i] / bin_size][static_cast<std::size_t>(std::lround(error * cells_per_px))] += 1;
            pixels += 1;
        }
    }
    for (std::size_t bin = 0; pixels > 0 && bin < bin_count; ++bin) {
        std::transform(weight_[bin].begin(), weight_[bin].end(), counted[bin].begin(), weight_[bin].begin(),
                       [pixels](double sum, double count) { return sum + count / pixels; });
    }
}

void ErrorSpread::add(const ErrorSpread& other) {
    for (std::size_t bin = 0; bin < bin_count; ++bin) {
        std::transform(weight_[bin].begin(), weight_[bin].end(), other.weight_[bin].begin(), weight_[bin].begin(),
                       std::plus<>());
    }
}

ErrorSpread::Cells ErrorSpread::all() const {
    Cells sum{};
    for (const Cells& cells : weight_) {
        std::transform(sum.begin(), sum.end(), cells.begin(), sum.begin(), std::plus<>());
    }
    return sum;
}

double ErrorSpread::sigma_of(const Cells& cells) {
    return sigma_of_median * quantile_of(cells, 0.5);
}

double ErrorSpread::quantile_of(const Cells& cells, double share) {
    const double wanted = share * std::accumulate(cells.begin(), cells.end(), 0.0);
    double before = 0;
    for (std::size_t cell = 0; cell < cells.size(); ++cell) {
        if (cells[cell] > 0 && before + cells[cell] >= wanted) {
            // A cell reaches from half a cell below its place to half a cell above it; the first one begins at 0.
            const double begin = std::max(static_cast<double>(cell) - 0.5, 0.0);
            const double end = static_cast<double>(cell) + 0.5;
            return (begin + (end - begin) * (wanted - before) / cells[cell]) / cells_per_px;
        }
        before += cells[cell];
    }
    return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace disparityd::eval
