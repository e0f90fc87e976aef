// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernels/cpu/cost/gradient_kernels.h"
#include "kernels/cpu/sgm/sgm_kernels.h"
#include "kernels/noise/noise_level.h"
#include "tests/kernels/check/kernel_case.h"

namespace disparityd::test {

/// Where winners go, guarded, all of them compared.
inline cpu::WinnerPlanes winner_planes(const KernelInput& input, RunBuffers& buffers) {
    return {buffers.result<std::int16_t>(input.width, input.height),
            buffers.result<std::uint8_t>(input.width, input.height),
            buffers.result<std::int16_t>(input.width, input.height),
            buffers.result<std::int16_t>(input.width, input.height)};
}

/// The kernels of an instruction set for an input, and rows of candidates between the layout of its registers and the
/// reference's order.
struct SgmLayout {
    SgmLayout(const KernelInput& input, std::int64_t target)
        : kernels(kernels_for(input.options, target)),
          geometry(cpu::geometry_for(kernels, input.width, input.height, input.options.range)) {}

    static cpu::SgmKernels kernels_for(const MatchOptions& options, std::int64_t target) {
        cpu::SgmKernels kernels = cpu::sgm_kernels(target, options.range.count);
        cpu::use_cost(options.cost, target, options.range.count, kernels);
        return kernels;
    }

    /// Where candidate k of column x lies in a row.
    std::size_t at(int x, int k) const {
        const cpu::DisparityLayout& layout = geometry.layout;
        return static_cast<std::size_t>(x) * layout.bytes() +
               static_cast<std::size_t>(k % layout.registers * layout.lanes + k / layout.registers);
    }

    /// A row in the reference's order, each entry less `bias`.
    std::vector<std::uint8_t> row(const std::uint8_t* laid_out, int bias = 0) const {
        std::vector<std::uint8_t> candidates;
        for (int x = 0; x < geometry.width; ++x) {
            for (int k = 0; k < geometry.range.count; ++k) {
                candidates.push_back(static_cast<std::uint8_t>(laid_out[at(x, k)] - bias));
            }
        }
        return candidates;
    }
    std::vector<std::uint8_t> costs_row(const std::uint8_t* laid_out) const {
        return row(laid_out, geometry.cost_bias);
    }

    /// The reverse; `padding` for what is no candidate.
    void lay_out(const std::uint8_t* candidates, std::uint8_t padding, std::uint8_t* laid_out, int bias = 0) const {
        std::fill_n(laid_out, geometry.row_bytes(), static_cast<std::uint8_t>(padding + bias));
        for (int x = 0; x < geometry.width; ++x) {
            for (int k = 0; k < geometry.range.count; ++k) {
                laid_out[at(x, k)] = static_cast<std::uint8_t>(*candidates++ + bias);
            }
        }
    }
    void lay_out_costs(const std::uint8_t* candidates, std::uint8_t* laid_out) const {
        lay_out(candidates, cpu::padding_cost, laid_out, geometry.cost_bias);
    }

    std::size_t rows_bytes() const { return geometry.row_bytes() * static_cast<std::size_t>(geometry.height); }
    std::size_t left_planes() const { return geometry.census.left_row() * static_cast<std::size_t>(geometry.height); }
    std::size_t right_planes() const { return geometry.census.right_row() * static_cast<std::size_t>(geometry.height); }

    cpu::SgmKernels kernels;
    cpu::MatchGeometry geometry;
};

/// Census planes of a pair in guarded memory, and matching costs from them.
struct SgmPlanes {
    SgmPlanes(const SgmLayout& of, RunBuffers& buffers)
        : layout(of),
          left(buffers.memory<std::uint8_t>(of.left_planes())),
          right(buffers.memory<std::uint8_t>(of.right_planes())) {
        if (of.kernels.averages_costs) {
            const std::span<std::uint8_t> rows = buffers.memory<std::uint8_t>(cpu::SingleRowCosts::bytes(of.geometry));
            single = cpu::SingleRowCosts(of.geometry, rows.data());
        }
    }

    void census(const ImagePair& pair, const KernelInput& input) {
        single.forget();
        const int coarseness = census_coarseness(input.options.noise_level);
        const cpu::CensusKernels& census =
            coarseness > 0 ? layout.kernels.noisy_census[coarseness - 1] : layout.kernels.census;
        over_parts(input, [&](Rows rows) {
            census.left(layout.geometry, pair.left.plane(), pair.smoothed_left.plane(), left.data(), rows);
            census.right(layout.geometry, pair.right.plane(), pair.smoothed_right.plane(), right.data(), rows);
        });
    }
    void matching_cost(int y, std::uint8_t* row, std::uint8_t* streamed = nullptr) {
        const cpu::CensusPlanes<const std::uint8_t> planes(left.data(), right.data());
        layout.kernels.matching_cost(layout.geometry, planes, y, y, &single, row, streamed);
    }

    const SgmLayout& layout;
    std::span<std::uint8_t> left, right;
    cpu::SingleRowCosts single;
};

}  // namespace disparityd::test
