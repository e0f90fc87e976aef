// SPDX-License-Identifier: Apache-2.0
// The kernels of block matching, from images or census planes to winners, beside the steps of the reference.
#include "kernels/cpu/block_kernels.h"
#include "tests/kernels/check/sgm_layout.h"

namespace disparityd::test {
namespace {

struct BlockData {
    explicit BlockData(const KernelInput& from)
        : input(from), random(from.seed), pair(random, from), out(winner_planes(from, buffers)) {}

    template <typename T>
    Volume<T> volume(std::vector<T>& of) const {
        return {of.data(), input.width, input.height, input.options.range.count};
    }
    std::size_t candidates() const {
        return pair.left.pixels().size() * static_cast<std::size_t>(input.options.range.count);
    }
    template <typename T>
    void winners(Volume<const T> costs) const {
        const MatchOptions& options = input.options;
        over_parts(input, [&](Rows rows) {
            reference::winner_left<T>(costs, options.range, options.post.subpixel, out.winner, out.disparity, rows);
            reference::winner_right<T>(costs, options.range, out.right_winner, rows);
            reference::local_extrema<T>(costs, options.range, options.post, out.winner, out.disparity, out.confidence,
                                        rows);
        });
    }
    KernelRun run(std::function<void()> kernel, std::shared_ptr<BlockData> self) const {
        return {std::move(kernel),
                {},
                [self] { return self->buffers.results(); },
                [self] { return self->buffers.intact(); }};
    }

    KernelInput input;
    Random random;
    ImagePair pair;
    RunBuffers buffers;
    cpu::WinnerPlanes out;
};

KernelRun bind_sad(const KernelInput& input, std::int64_t target) {
    const auto data = std::make_shared<BlockData>(input);
    if (target == 0) {
        const auto costs = std::make_shared<std::vector<std::uint16_t>>(data->candidates());
        return data->run(
            [data, costs] {
                over_parts(data->input, [&](Rows rows) {
                    reference::sad(data->pair.left.plane(), data->pair.right.plane(), data->input.options.range,
                                   data->volume(*costs), rows);
                });
                data->winners<std::uint16_t>(data->volume(*costs));
            },
            data);
    }
    const auto layout = std::make_shared<SgmLayout>(input, target);
    const cpu::BlockKernels kernels = cpu::block_kernels(target, input.options.range.count);
    const auto scratch = data->buffers.memory<std::uint8_t>(kernels.scratch_bytes(layout->geometry));
    return data->run(
        [data, layout, kernels, scratch] {
            over_parts(data->input, [&](Rows rows) {
                kernels.sad(layout->geometry, data->input.options.post, data->pair.left.plane(),
                            data->pair.right.plane(), rows, scratch.data(), data->out);
            });
        },
        data);
}

// From census words, or census planes: those are a kernel of their own.
KernelRun bind_census_blocks(const KernelInput& input, std::int64_t target) {
    const auto data = std::make_shared<BlockData>(input);
    if (target == 0) {
        const auto left = std::make_shared<Image<std::uint64_t>>(input.width, input.height);
        const auto right = std::make_shared<Image<std::uint64_t>>(input.width, input.height);
        const CensusSteps& steps = reference::steps.matching.of(input.options.cost);
        steps.census(data->pair.left.plane(), left->plane(), left->rows());
        steps.census(data->pair.right.plane(), right->plane(), right->rows());
        const auto costs = std::make_shared<std::vector<std::uint8_t>>(data->candidates());
        return data->run(
            [data, left, right, costs] {
                over_parts(data->input, [&](Rows rows) {
                    reference::steps.matching.of(data->input.options.cost)
                        .matching_cost(left->plane(), right->plane(), data->input.options.range, data->volume(*costs),
                                       rows);
                });
                data->winners<std::uint8_t>(data->volume(*costs));
            },
            data);
    }
    const auto layout = std::make_shared<SgmLayout>(input, target);
    layout->geometry.cost_bias = 0;  // only paths want one
    const auto planes = std::make_shared<SgmPlanes>(*layout, data->buffers);
    planes->census(data->pair, input);
    const cpu::BlockKernels kernels = cpu::block_kernels(target, input.options.range.count);
    const auto scratch = data->buffers.memory<std::uint8_t>(kernels.scratch_bytes(layout->geometry));
    return data->run(
        [data, layout, planes, kernels, scratch] {
            over_parts(data->input, [&](Rows rows) {
                kernels.census(layout->geometry, data->input.options.post, layout->kernels.matching_cost,
                               {planes->left.data(), planes->right.data()}, rows, scratch.data(), data->out);
            });
        },
        data);
}

}  // namespace

std::vector<KernelCase> block_cases() {
    return {{"block/sad", bind_sad},
            {"block/census", bind_census_blocks},
            {"block/census_gradient", with_gradient_cost(bind_census_blocks)}};
}

}  // namespace disparityd::test
