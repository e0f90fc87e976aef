// SPDX-License-Identifier: Apache-2.0
// Step 4 of docs/algorithm.md, one row: costs of all candidates, those outside the right image and padding put in their
// places.
#if defined(DISPARITYD_CPU_COST_MATCHING_COST_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_COST_MATCHING_COST_INL_H_
#undef DISPARITYD_CPU_COST_MATCHING_COST_INL_H_
#else
#define DISPARITYD_CPU_COST_MATCHING_COST_INL_H_
#endif

#include <algorithm>
#include <type_traits>

#include "kernels/cpu/cost/census_planes-inl.h"
#include "kernels/cpu/cost/costs_of_planes-inl.h"
#include "kernels/cpu/cost/costs_of_words-inl.h"
#include "kernels/cpu/cost/single_row_costs.h"
#include "kernels/cpu/simd/prefetch-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

template <class Tag, int registers, class Cost>
using CostsOfPixels = std::conditional_t<in_words<Cost>(registers), CostsOfWords<Tag>,
                                         CostsOfPlanes<Tag, registers, Cost, Cost::averaged>>;

template <class Tag, int registers, class Cost>
class MatchingCostRow {
    using V = hn::Vec<Tag>;
    using Costs = CostsOfPixels<Tag, registers, Cost>;
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Tag()));
    static constexpr int at_once = Costs::at_once;

public:
    /// Of the row `census`, or of that row averaged `with` others. `streamed` gets a copy if it is not null.
    template <class... With>
    MatchingCostRow(const MatchGeometry& geometry, const CensusRow& census, const CensusRow& next, std::uint8_t* costs,
                    std::uint8_t* streamed, const With&... with)
        : geometry_(geometry),
          next_(next),
          out_(costs, streamed),
          least_(geometry.range.count, geometry.cost_bias),
          pixels_(geometry, census, out_, least_.are_some() ? &least_ : nullptr, with...),
          bias_(static_cast<std::uint8_t>(geometry.cost_bias)) {}
    MatchingCostRow(const MatchingCostRow&) = delete;
    MatchingCostRow& operator=(const MatchingCostRow&) = delete;

    /// Not in line: within the loops around it, its own find too few registers.
    HWY_NOINLINE void run() const {
        const int width = geometry_.width;
        const DisparityRange range = geometry_.range;
        // From `first` to `end` all candidates are inside the right image.
        const int first = std::clamp(range.first + range.count - 1, 0, width);
        const int end = std::clamp(width + range.first, first, width);
        Prefetch left({next_.left, geometry_.census.left_row()}, std::max(width / at_once, 1));
        Prefetch right({next_.right, geometry_.census.right_row()}, std::max(width / at_once, 1));
        const auto next = [&]() HWY_ATTR {
            left.portion();
            right.portion();
        };
        if constexpr (Costs::pixels_of_lines > 0) {
            if (out_.has_copy()) {
                const int first_streamed = std::min(rounded_up(first, Costs::pixels_of_lines), end);
                pixels_.template between<false>(0, first_streamed, next);
                pixels_.template between<true>(first_streamed, end, next);
                pixels_.template between<false>(end, width, next);
                set_outside<true>(0, first_streamed);
                set_outside<true>(end, width);
                return;
            }
        }
        pixels_.template between<false>(0, width, next);
        set_outside<false>(0, first);
        set_outside<false>(end, width);
        if (out_.has_copy()) {
            out_.stream(width);
        }
    }

private:
    std::uint8_t outside() const { return static_cast<std::uint8_t>(bias_ + Cost::outside); }

    /// Candidates outside the right image, of pixels [x, end).
    template <bool streaming>
    void set_outside(int x, int end) const {
        const int width = geometry_.width;
        const DisparityRange range = geometry_.range;
        V k[registers];
        DISPARITYD_UNROLL
        for (int r = 0; r < registers; ++r) {
            k[r] = hn::Load(tag_, candidate_of_lane<registers, lanes>.in[r]);
        }
        for (; x < end; ++x) {
            const int first = std::clamp(x - (width - 1) - range.first, 0, range.count);
            const int last = std::clamp(x + 1 - range.first, first, range.count);
            V cost[registers];
            DISPARITYD_UNROLL
            for (int r = 0; r < registers; ++r) {
                cost[r] = hn::Load(tag_, out_.at(x, r));
                cost[r] = first == last ? hn::Set(tag_, outside()) : keep(cost[r], k[r], first, last);
                cost[r] = hn::Max(cost[r], least_.at(r));
            }
            out_.template store<streaming>(cost, registers, x);
        }
    }

    /// The cost where candidate k is one of first .. last - 1.
    V keep(V cost, V k, int first, int last) const {
        const V from_first = hn::Sub(k, hn::Set(tag_, static_cast<std::uint8_t>(first)));
        const V limit = hn::Set(tag_, static_cast<std::uint8_t>(last - 1 - first));
        return hn::IfThenElse(hn::Eq(hn::Max(from_first, limit), limit), cost, hn::Set(tag_, outside()));
    }

    const Tag tag_{};
    const MatchGeometry& geometry_;
    CensusRow next_;
    CostRow<Tag, registers> out_;
    LeastCosts<Tag, registers> least_;
    Costs pixels_;
    std::uint8_t bias_;
};

/// SgmKernels::matching_cost.
template <class Tag, int registers, class Cost>
void matching_cost(const MatchGeometry& geometry, CensusPlanes<const std::uint8_t> planes, int y, int next,
                   SingleRowCosts* single, std::uint8_t* costs, std::uint8_t* streamed) {
    using Row = MatchingCostRow<Tag, registers, Cost>;
    const auto census = [&](int row) { return planes.row(geometry.census, row); };
    if constexpr (!Cost::averaged) {
        (void)single;
        Row(geometry, census(y), census(next), costs, streamed).run();
    } else {
        const int last_row = geometry.height - 1;
        const int above = std::max(y - 1, 0);
        const int below = std::min(y + 1, last_row);
        // A worker that goes up has the row below.
        const int fresh = single->has(below) ? above : below;
        const int other = fresh == below ? above : below;
        for (const int row : {y, other}) {
            if (!single->has(row)) {
                const CostRow<Tag, registers> to(single->put(row), nullptr);
                const CostsOfPlanes<Tag, registers, Cost, false> alone(geometry, census(row), to, nullptr);
                alone.template between<false>(0, geometry.width, [] {});
            }
        }
        const Averaged with{single->put(fresh), single->of(y), single->of(other)};
        const CensusRow soon = census(std::clamp(next + fresh - y, 0, last_row));
        Row(geometry, census(fresh), soon, costs, streamed, with).run();
    }
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
