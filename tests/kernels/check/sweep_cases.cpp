// SPDX-License-Identifier: Apache-2.0
// The kernels of a sweep: four paths over rows, and the penalties of adaptive P2.
#include "tests/kernels/check/sgm_layout.h"

namespace disparityd::test {
namespace {

/// Rows from image to sums in both directions, the way SgmSweeps goes but over the whole image.
struct TwoSweeps {
    TwoSweeps(const KernelInput& from, std::int64_t target, cpu::Store how)
        : input(from), store(how), random(from.seed), pair(random, from), layout(from, target) {
        SgmPlanes planes(layout, buffers);
        planes.census(pair, input);
        const std::size_t bytes = layout.rows_bytes();
        for (auto* volume : {&costs, &sums[0], &sums[1], &streamed_costs}) {
            *volume = buffers.memory<std::uint8_t>(bytes);
        }
        for (int y = 0; y < input.height; ++y) {
            planes.matching_cost(y, row(costs, y), store == cpu::Store::stream ? row(streamed_costs, y) : nullptr);
        }
        path_pixels = static_cast<std::size_t>(input.width + 2 * cpu::path_guard);
        path_costs = buffers.memory<std::uint8_t>(3 * path_pixels * layout.geometry.layout.bytes());
        path_min = buffers.memory<std::uint8_t>(3 * path_pixels);
        p2_row_bytes = (path_pixels + 63) / 64 * 64;
        p2_rows = buffers.memory<std::uint8_t>(4 * p2_row_bytes * static_cast<std::size_t>(input.height));
    }

    std::uint8_t* row(std::span<std::uint8_t> volume, int y) const {
        return volume.data() + static_cast<std::size_t>(y) * layout.geometry.row_bytes();
    }

    /// Outside the image a path adds nothing.
    cpu::PathRow path_row() const {
        std::fill(path_costs.begin(), path_costs.end(), std::uint8_t{0});
        std::fill(path_min.begin(), path_min.end(), std::uint8_t{0});
        cpu::PathRow before;
        for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t first = i * path_pixels + cpu::path_guard;
            before.costs[i] = path_costs.data() + first * layout.geometry.layout.bytes();
            before.least[i] = path_min.data() + first;
        }
        return before;
    }

    cpu::SweepPass pass(int direction) const { return {direction, input.options.sgm.p1, input.options.sgm.p2, store}; }

    cpu::SweepRow sweep_row(const cpu::SweepPass& of, int y) const {
        const int sweep = of.direction > 0 ? 0 : 1;
        cpu::SweepRow sweep_row;
        sweep_row.costs = row(costs, y);
        sweep_row.sums = row(sums[sweep], y);
        std::uint8_t* own = p2_rows.data() + 4 * p2_row_bytes * static_cast<std::size_t>(y);
        std::uint8_t* of_paths[4];
        for (std::size_t path = 0; path < 4; ++path) {
            of_paths[path] = own + path * p2_row_bytes;
            sweep_row.p2_rows[path] = of_paths[path];
            std::memset(of_paths[path], input.options.sgm.p2, p2_row_bytes);
        }
        if (input.options.sgm.adaptive_p2) {
            const int before = std::clamp(y - of.direction, 0, input.height - 1);
            layout.kernels.adaptive_p2(layout.geometry, of.direction, input.options.sgm, pair.left.plane().row(y),
                                       pair.left.plane().row(before), of_paths);
        }
        return sweep_row;
    }

    void aggregate(const cpu::SweepPass& of, const cpu::PathRow& before, const cpu::SweepRow* rows, int count) const {
        // In two calls, as workers do that wait for each other in between.
        alignas(64) std::uint8_t state[cpu::max_sweep_state];
        const int steps = cpu::steps_of(input.width, count);
        const int first = steps / 2 / cpu::min_block * cpu::min_block;
        for (const cpu::SweepSteps part : {cpu::SweepSteps{0, first}, cpu::SweepSteps{first, steps}}) {
            if (part.end > part.first) {
                layout.kernels.aggregate(layout.geometry, of, before, rows, count, part, state);
            }
        }
    }

    void sweep(int direction) const {
        const cpu::SweepPass of = pass(direction);
        const cpu::PathRow before = path_row();
        for (int i = 0; i < input.height;) {
            cpu::SweepRow rows[2];
            const int count = std::min(layout.kernels.rows_at_once, input.height - i);
            for (int k = 0; k < count; ++k) {
                rows[k] = sweep_row(of, direction > 0 ? i + k : input.height - 1 - i - k);
            }
            aggregate(of, before, rows, count);
            i += count;
        }
    }

    /// S of every candidate in the reference's order, and costs as they were streamed.
    std::vector<std::uint8_t> results() const {
        std::vector<std::uint16_t> all;
        std::vector<std::uint8_t> streamed;
        for (int y = 0; y < input.height; ++y) {
            const auto cost = layout.costs_row(row(costs, y));
            const auto down = layout.row(row(sums[0], y)), up = layout.row(row(sums[1], y));
            for (std::size_t i = 0; i < cost.size(); ++i) {
                all.push_back(static_cast<std::uint16_t>(down[i] + up[i] + 8 * cost[i]));
            }
            const auto found = layout.costs_row(row(store == cpu::Store::stream ? streamed_costs : costs, y));
            streamed.insert(streamed.end(), found.begin(), found.end());
        }
        const auto* raw = reinterpret_cast<const std::uint8_t*>(all.data());
        streamed.insert(streamed.end(), raw, raw + all.size() * sizeof(all[0]));
        return streamed;
    }

    KernelInput input;
    cpu::Store store;
    Random random;
    ImagePair pair;
    SgmLayout layout;
    RunBuffers buffers;
    std::span<std::uint8_t> costs, sums[2], streamed_costs, path_costs, path_min, p2_rows;
    std::size_t path_pixels = 0;
    std::size_t p2_row_bytes = 0;
};

struct PlainPaths {
    explicit PlainPaths(const KernelInput& from)
        : input(from),
          random(from.seed),
          pair(random, from),
          costs(pair.left.pixels().size() * static_cast<std::size_t>(from.options.range.count)),
          sums(costs.size()),
          scratch(reference::aggregate_scratch(from.width, from.height, from.options.range.count)) {
        Image<std::uint64_t> left(from.width, from.height), right(from.width, from.height);
        const CensusSteps& steps = reference::steps.matching.of(from.options.cost);
        steps.census(pair.left.plane(), left.plane(), left.rows());
        steps.census(pair.right.plane(), right.plane(), right.rows());
        steps.matching_cost(left.plane(), right.plane(), from.options.range, volume(costs), left.rows());
    }
    template <typename T>
    Volume<T> volume(std::vector<T>& of) {
        return {of.data(), input.width, input.height, input.options.range.count};
    }
    std::vector<std::uint8_t> results() const {
        std::vector<std::uint8_t> all = costs;
        const auto* raw = reinterpret_cast<const std::uint8_t*>(sums.data());
        all.insert(all.end(), raw, raw + sums.size() * sizeof(sums[0]));
        return all;
    }

    KernelInput input;
    Random random;
    ImagePair pair;
    std::vector<std::uint8_t> costs;
    std::vector<std::uint16_t> sums;
    std::vector<std::byte> scratch;
};

KernelRun bind_aggregate(const KernelInput& input, std::int64_t target, cpu::Store store) {
    if (target == 0) {
        const auto plain = std::make_shared<PlainPaths>(input);
        return {[plain] {
                    Serial serial;
                    reference::aggregate(plain->volume(plain->costs), plain->pair.left.plane(),
                                         plain->input.options.sgm, plain->volume(plain->sums), plain->scratch, serial);
                },
                {},
                [plain] { return plain->results(); },
                [] { return true; }};
    }
    const auto sweeps = std::make_shared<TwoSweeps>(input, target, store);
    return {[sweeps] {
                sweeps->sweep(1);
                sweeps->sweep(-1);
            },
            {},
            [sweeps] { return sweeps->results(); },
            [sweeps] { return sweeps->buffers.intact(); }};
}

/// P2' of docs/algorithm.md for the paths into position p of a sweep, where the pixel before is inside the image; what
/// other positions hold does not matter.
class PlainAdaptiveP2 {
public:
    explicit PlainAdaptiveP2(const KernelInput& from) : input(from), random(from.seed), pair(random, from) {}

    bool inside(int p, int y, int path) const {
        const int before = p + (path == 3 ? -1 : path - 1);
        return before >= 0 && before < input.width && (path == 3 || y > 0);
    }
    std::uint8_t p2(int p, int y, int path) const {
        const int before = p + (path == 3 ? -1 : path - 1);
        const int difference = std::abs(pair.left.at(p, y) - pair.left.at(before, path == 3 ? y : y - 1));
        const SgmOptions& sgm = input.options.sgm;
        return static_cast<std::uint8_t>(std::max({sgm.p1 + 1, sgm.p2_min, sgm.p2 - sgm.p2_slope * difference}));
    }

    KernelInput input;
    Random random;
    ImagePair pair;
};

// Downwards: position and column are the same. The way back is a matter of mirroring, which sgm/aggregate compares.
KernelRun bind_adaptive_p2(const KernelInput& input, std::int64_t target) {
    const auto plain = std::make_shared<PlainAdaptiveP2>(input);
    const auto pitch = static_cast<std::size_t>((input.width + 63) / 64 * 64);
    const auto buffers = std::make_shared<RunBuffers>();
    const auto p2_rows = buffers->memory<std::uint8_t>(4 * pitch * static_cast<std::size_t>(input.height));
    const auto at = [=](int p, int y, int path) -> std::uint8_t& {
        return p2_rows[(static_cast<std::size_t>(y) * 4 + static_cast<std::size_t>(path)) * pitch +
                       static_cast<std::size_t>(p)];
    };
    const auto results = [=] {
        std::vector<std::uint8_t> all;
        for (int y = 0; y < input.height; ++y) {
            for (int path = 0; path < 4; ++path) {
                for (int p = 0; p < input.width; ++p) {
                    all.push_back(plain->inside(p, y, path) ? at(p, y, path) : 0);
                }
            }
        }
        return all;
    };
    const auto intact = [buffers] { return buffers->intact(); };
    if (target == 0) {
        return {[=] {
                    for (int y = 0; y < input.height; ++y) {
                        for (int path = 0; path < 4; ++path) {
                            for (int p = 0; p < input.width; ++p) {
                                at(p, y, path) = plain->inside(p, y, path) ? plain->p2(p, y, path) : 0;
                            }
                        }
                    }
                },
                {},
                results,
                intact};
    }
    const auto layout = std::make_shared<SgmLayout>(input, target);
    return {[=] {
                for (int y = 0; y < input.height; ++y) {
                    std::uint8_t* rows[4] = {&at(0, y, 0), &at(0, y, 1), &at(0, y, 2), &at(0, y, 3)};
                    layout->kernels.adaptive_p2(layout->geometry, 1, input.options.sgm, plain->pair.left.plane().row(y),
                                                plain->pair.left.plane().row(std::max(0, y - 1)), rows);
                }
            },
            {},
            results,
            intact};
}

}  // namespace

std::vector<KernelCase> sweep_cases() {
    return {
        {"sgm/aggregate",
         [](const KernelInput& input, std::int64_t target) { return bind_aggregate(input, target, cpu::Store::keep); },
         cpu::max_byte_p2},
        {"sgm/aggregate_streamed",
         [](const KernelInput& input, std::int64_t target) {
             return bind_aggregate(input, target, cpu::Store::stream);
         },
         cpu::max_byte_p2},
        {"sgm/adaptive_p2", bind_adaptive_p2, 193, true}};
}

}  // namespace disparityd::test
